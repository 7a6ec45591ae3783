#!/usr/bin/env python3
"""Leads grbl-streamer, a library that streams to Grbl.

    streamer.py draw PORT FILE [characters|answers]   the drawing, counting characters or waiting for each answer
    streamer.py lead PORT                             settings, homing, jog, hold, resume, reset, unlock
"""
import sys
import threading
import time

from grbl_streamer import GrblStreamer

PATIENCE_S = 120


class Led:
    """The library, and what it has told."""

    def __init__(self, port):
        self.state, self.at, self.errors, self.runs = None, None, [], False
        self.events = {}
        self.news = threading.Condition()
        self.grbl = GrblStreamer(self.hear)
        self.grbl.setup_logging()
        self.grbl.cnect(port, 115200)
        self.wait("on_boot")
        self.grbl.poll_interval = 0.1
        self.grbl.poll_start()

    def hear(self, event, *data):
        with getattr(self, "news", threading.Condition()):
            if event == "on_stateupdate":
                self.state, self.at = data[0], data[1]
            elif event == "on_rx_buffer_percent" and self.runs:
                # In the library's own thread, in which it sends on at each answer. Nothing holds its threads
                # apart: begun in another one, a line is sent twice or not at all if the first answer comes
                # early.
                self.runs = False
                self.grbl.job_run()
            elif event in ("on_error", "on_alarm"):
                self.errors.append(data)
            self.events.setdefault(event, []).append(data)
            if hasattr(self, "news"):
                self.news.notify_all()

    def until(self, what, holds):
        end = time.monotonic() + PATIENCE_S
        with self.news:
            while not holds():
                if not self.news.wait(end - time.monotonic()) and time.monotonic() >= end:
                    sys.exit(f"not seen: {what}; state {self.state} at {self.at}, errors {self.errors}")

    def wait(self, event, since=0):
        self.until(event, lambda: len(self.events.get(event, [])) > since)

    def stands(self, *states):
        self.until(" or ".join(states), lambda: self.state and self.state.split(":")[0] in states)

    def said(self, words):
        print("  " + words, flush=True)


def draw(port, path, way="characters"):
    led = Led(port)
    led.stands("Idle")
    led.grbl.incremental_streaming = way == "answers"
    led.grbl.load_file(path)
    most, led.runs = 0, True
    led.grbl.gcode_parser_state_requested = True  # the job begins behind its answer
    led.until("the job begins", lambda: not led.runs)
    end = time.monotonic() + 2 * PATIENCE_S
    while not led.grbl.job_finished:
        most = max(most, len(led.grbl._rx_buffer_fill))
        if led.errors or time.monotonic() > end:
            sys.exit(f"not drawn: {led.errors}")
        time.sleep(0.01)
    led.until("idle at the origin", lambda: led.state == "Idle" and tuple(led.at[:2]) == (0.0, 0.0))
    if led.errors:
        sys.exit(f"refused: {led.errors}")
    led.said(f"{led.grbl.buffer_size} lines by {way}, up to {most} of them unanswered")
    led.grbl.disconnect()


def expect(led, x):
    if abs(led.at[0] - x) > 0.01:  # mm: a step is 0.0114
        sys.exit(f"x should be {x}: {led.at}")


def lead(port):
    led = Led(port)
    grbl = led.grbl
    led.stands("Idle")
    # As Grbl 1.1 says them, without words behind: the library reads those of 0.9 only, and hands these on.
    led.until("$132=", lambda: any(line.startswith("$132=") for line, in led.events["on_read"]))
    settings = [line for line, in led.events["on_read"] if line.startswith("$")]
    led.said(f"settings: {len(settings)}, {settings[0]} to {settings[-1]}")
    grbl.send_immediately("$22=1")
    time.sleep(0.5)
    grbl.homing()
    led.stands("Home")
    led.stands("Idle")
    expect(led, 0)
    led.said(f"homed: {led.state} at {led.at}")
    grbl.send_immediately("$J=G91 X20 F600")
    led.stands("Jog")
    led.stands("Idle")
    expect(led, 20)
    led.said(f"jogged: {led.state} at {led.at}")
    grbl.send_immediately("M3 S90")
    time.sleep(0.5)
    grbl.send_immediately("G1 X170 F300")
    led.stands("Run")
    grbl.hold()
    led.until("it stands", lambda: led.state == "Hold:0")
    held = led.at
    led.said(f"held: {led.state} at {held}")
    grbl.resume()
    led.stands("Run")
    led.until("on its way behind the hold", lambda: led.at[0] > held[0] + 1)
    boots = len(led.events["on_boot"])
    grbl.softreset()
    led.wait("on_boot", boots)
    led.stands("Alarm")
    led.said(f"reset on its way: {led.state} at {led.at}")
    grbl.killalarm()
    led.stands("Idle")
    led.said(f"unlocked: {led.state} at {led.at}")
    grbl.disconnect()


if __name__ == "__main__":
    {"draw": draw, "lead": lead}[sys.argv[1]](*sys.argv[2:])
