#!/usr/bin/env python3
"""Runs a sender on a simulated machine, and compares what the motors did with the plan.

    machine.py NAME SPEED PLAN|- COMMAND...

Starts `plotter-replay simulate` with the stepper plotter, which speaks Grbl, on a pseudo terminal of its own;
runs COMMAND, in which PORT stands for its name; ends the machine, runs its controller again on its own log
(`plotter-replay check`), and compares each step and the pen in it with PLAN, the file of `stepper --steps`. With
`-` the steps are only counted: a person moved the machine by hand.

PLOTTER_REPLAY is the program, SENDERS_OUT a folder for NAME.plog, NAME.gcode.txt and what was said.
"""
import os
import pathlib
import signal
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
MACHINE = HERE.parent / "machines" / "stepper-plotter.toml"
PATIENCE_S = 240  # for a sender; on a busy computer the machine falls behind
ALL_S = PATIENCE_S + 120  # for it, the machine's start and end, and the run on its log


class Wrong(Exception):
    """What is not as it should be, for a person."""


def planned(path):
    """Steps of the plan: axis, sign, whether the pen is down."""
    steps = []
    with open(path, encoding="ascii") as lines:
        for line in lines:
            if line.startswith("#"):
                continue
            _, dx, dy, pen = line.split()
            steps += [(axis, int(by), pen == "1") for axis, by in (("x", dx), ("y", dy)) if by != "0"]
    return steps


def made(path):
    """Steps that the log has."""
    steps, down = [], False
    with open(path, encoding="ascii") as lines:
        for line in lines:
            words = line.split(" ")
            if words[1:3] == ["@", "edge"]:
                steps.append((words[3][0], int(words[3][1] + "1"), down))
            elif words[1:3] == ["@", "pen"]:
                down = words[3] == "down"
    return steps


def compare(plan, log):
    want, got = planned(plan), made(log)
    if want == got:
        return f"{len(got)} steps, those of the plan, each with its pen"
    same = next((n for n, pair in enumerate(zip(want, got)) if pair[0] != pair[1]), min(len(want), len(got)))
    raise Wrong(f"{len(got)} steps, {len(want)} planned; the first {same} are equal, then {got[same:same + 1]} for {want[same:same + 1]}")


def run(name, speed, plan, command):
    program, out = os.environ["PLOTTER_REPLAY"], pathlib.Path(os.environ["SENDERS_OUT"])
    log = out / f"{name}.plog"
    with open(out / f"{name}.machine.txt", "w+", encoding="utf-8") as told:
        machine = subprocess.Popen(
            [program, "simulate", str(MACHINE), "--speed", speed, "-o", str(log), "--force"],
            stdout=subprocess.PIPE, stderr=told, text=True)
        try:
            first = machine.stdout.readline()
            if " is simulated on " not in first:
                raise Wrong(f"the machine did not start: {first}")
            port = first.split(" is simulated on ")[1].strip()
            # What it says more is kept, so that it never waits for a reader.
            keep = subprocess.Popen(["cat"], stdin=machine.stdout, stdout=told)
            lead(name, [word.replace("PORT", port) for word in command], out)
        finally:
            machine.send_signal(signal.SIGINT)
            status = machine.wait(60)
        keep.wait(60)
        if status != 0:
            told.seek(0)
            raise Wrong(f"the machine ended with status {status}: {told.read()[-500:]}")
    checked = subprocess.run([program, "check", str(log), "--machine", str(MACHINE)], capture_output=True, text=True)
    if checked.returncode != 0:
        raise Wrong(f"its controller does not do the same again: {checked.stdout}{checked.stderr}")
    return f"{len(made(log))} steps" if plan == "-" else compare(plan, log)


def lead(name, command, out):
    with open(out / f"{name}.sender.txt", "w+", encoding="utf-8") as said:
        sender = subprocess.Popen(command, stdout=said, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            status = sender.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            status = f"none within {PATIENCE_S} s"
        finally:
            try:  # and all that it started
                os.killpg(sender.pid, signal.SIGKILL)
            except ProcessLookupError:
                pass
        said.seek(0)
        text = said.read()
    for line in text.splitlines():
        if line.startswith("  "):
            print(line)
    if status != 0:
        raise Wrong(f"the sender ended with status {status}: {text[-2000:]}")


def over(signal_number, _):
    raise Wrong(f"stopped by {signal.Signals(signal_number).name}: it may take {ALL_S} s")


if __name__ == "__main__":
    _, NAME, SPEED, PLAN, *COMMAND = sys.argv
    # Whatever hangs, the machine is ended.
    for ends in (signal.SIGALRM, signal.SIGTERM):
        signal.signal(ends, over)
    signal.alarm(ALL_S)
    try:
        print(f"{NAME}: {run(NAME, SPEED, PLAN, COMMAND)}", flush=True)
    except Wrong as wrong:
        print(f"{NAME}: {wrong}", file=sys.stderr)
        sys.exit(1)
