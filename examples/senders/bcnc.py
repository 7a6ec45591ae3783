#!/usr/bin/env python3
"""Leads bCNC, a program with a window, by its pendant: the page that it offers to a telephone.

    bcnc.py draw PORT FILE   the drawing, with a pause and a resume on its way
    bcnc.py lead PORT        a setting, homing, jog and its end, hold and resume, overrides, reset, unlock

It runs on a screen that nobody sees (Xvfb), with settings and a home of its own, which are taken away at the end.
BCNC is the Python that it was installed into.
"""
import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time
import urllib.parse
import urllib.request

PATIENCE_S = 150
SETTINGS = """
[bCNC]
lastcheck = 9999999
checkinterval = 0
[Connection]
port = {port}
baud = 115200
pendant = 1
pendantport = {http}
openserial = 1
controller = GRBL1
errorreport = 0
"""


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


class Led:
    def __init__(self, port, home):
        self.http = free_port()
        settings = pathlib.Path(home) / "settings.ini"
        settings.write_text(SETTINGS.format(port=port, http=self.http), encoding="ascii")
        # The least number of a screen that is free: Xvfb says it.
        reads, writes = os.pipe()
        self.screen = subprocess.Popen(["Xvfb", "-displayfd", str(writes), "-screen", "0", "1280x1024x24", "-nolisten", "tcp"], pass_fds=[writes])
        os.close(writes)
        with os.fdopen(reads) as said:
            number = said.readline().strip()
        if not number:
            sys.exit("Xvfb gives no screen")
        self.bcnc = subprocess.Popen(
            [os.environ["BCNC"], "-m", "bCNC", "-i", str(settings)],
            env={**os.environ, "DISPLAY": f":{number}", "HOME": home, "LANG": "C.UTF-8"})
        self.until("its pendant", lambda: self.state() is not None)
        self.stands("Idle", "Alarm")

    def ask(self, path, **words):
        query = "?" + urllib.parse.urlencode(words) if words else ""
        with urllib.request.urlopen(f"http://127.0.0.1:{self.http}{path}{query}", timeout=10) as answer:
            return answer.read()

    def state(self):
        if self.bcnc.poll() is not None:
            sys.exit(f"bCNC ended with status {self.bcnc.returncode}")
        try:
            return json.loads(self.ask("/state"))
        except OSError:
            return None

    def command(self, words):
        """A command of its own language, or a line for the machine."""
        self.ask("/send", cmd=words)

    def until(self, what, holds, patience_s=PATIENCE_S):
        end = time.monotonic() + patience_s
        while not holds():
            if time.monotonic() > end:
                sys.exit(f"not seen: {what}; {self.state()}")
            time.sleep(0.05)

    def active(self):
        return (self.state() or {}).get("state", "").split(":")[0]

    def stands(self, *states):
        self.until(" or ".join(states), lambda: self.active() in states)

    def at(self):
        state = self.state()
        return state["mx"], state["my"]

    def here(self):
        return f"{self.state()['state']} at {self.at()}"


def said(words):
    print("  " + words, flush=True)


def draw(led, path):
    led.command(f"LOAD {path}")
    time.sleep(2)
    led.command("RUN")
    led.until("the drawing on its way", lambda: led.active() == "Run" and led.at()[0] > 30)
    time.sleep(2)
    led.command("PAUSE")
    led.until("it stands", lambda: led.state()["state"] == "Hold:0")
    held = led.at()
    time.sleep(1)
    if led.at() != held:
        sys.exit(f"it goes on while it is held: {led.here()}")
    said(f"paused: {led.here()}")
    led.command("RESUME")
    led.stands("Run")
    # At its end bCNC resets the machine, unlocks it and asks for its state.
    led.until("the end of the drawing", lambda: led.active() == "Idle" and led.at() == (0, 0))
    time.sleep(4)
    led.stands("Idle")
    said(f"drawn: {led.here()}")


def near(led, x):
    if abs(led.at()[0] - x) > 0.012:  # mm: a step is 0.0114
        sys.exit(f"x should be {x}: {led.here()}")


def lead(led):
    led.command("$22=1")
    time.sleep(1)
    led.command("HOME")
    led.stands("Home")
    led.stands("Idle")
    near(led, 0)
    said(f"homed: {led.here()}")
    led.command("$J=G91 X10 F1200")
    led.until("the jog", lambda: led.active() == "Idle" and abs(led.at()[0] - 10) < 0.012)
    led.command("$J=G91 X200 F600")
    led.until("the jog on its way", lambda: led.active() == "Jog" and led.at()[0] > 11)
    led.command("SENDHEX 85")
    led.stands("Idle")
    if led.at()[0] > 209:
        sys.exit(f"the jog was not cancelled: {led.here()}")
    said(f"jogged by 10 mm, and on until it was cancelled: {led.here()}")
    x = led.at()[0]
    led.command("M3 S90")
    led.command(f"G1 X{x + 150:.3f} F300")
    led.until("the line on its way", lambda: led.active() == "Run" and led.at()[0] > x + 0.5)
    led.command("FEEDHOLD")
    led.until("it stands", lambda: led.state()["state"] == "Hold:0")
    said(f"held: {led.here()}")
    led.command("RESUME")
    led.stands("Run")
    for byte, name, want in (("91", "OvFeed", 110), ("94", "OvFeed", 109), ("90", "OvFeed", 100), ("97", "OvRapid", 25),
                             ("96", "OvRapid", 50), ("95", "OvRapid", 100), ("9B", "OvSpindle", 90), ("9C", "OvSpindle", 91),
                             ("99", "OvSpindle", 100)):
        led.command(f"SENDHEX {byte}")
        led.until(f"{name} of {want} %", lambda: led.state()[name] == want)
    said(f"overrides of feed, travels and power, each as reported; {led.here()}")
    led.stands("Run")
    led.command("RESET")
    led.stands("Alarm", "ALARM")
    said(f"reset on its way: {led.here()}")
    led.command("UNLOCK")
    led.stands("Idle")
    said(f"unlocked: {led.here()}")
    led.command("G0 X0 Y0")
    led.until("back at the origin", lambda: led.active() == "Idle" and led.at() == (0, 0))


def main(what, port, *rest):
    with tempfile.TemporaryDirectory() as home:
        led = None
        try:
            led = Led(port, home)
            {"draw": draw, "lead": lead}[what](led, *rest)
        finally:
            for process in (led and led.bcnc, led and led.screen):
                if process:
                    process.kill()
                    process.wait()


if __name__ == "__main__":
    main(*sys.argv[1:])
