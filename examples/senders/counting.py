#!/usr/bin/env python3
"""The least sender that counts characters: as much ahead as Grbl's receive buffer holds.

    counting.py PORT FILE

Grbl's interface page describes it: a line is sent as soon as it fits beside those that are not answered yet.
The lines are read from the port of a pseudo terminal, which needs no library.
"""
import collections
import os
import sys
import termios
import time
import tty

BUFFER = 128  # bytes: Grbl's receive buffer
PATIENCE_S = 60  # for the next answer


class Port:
    def __init__(self, name):
        self.file = os.open(name, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.file, termios.TCSANOW)  # what has come stays
        os.set_blocking(self.file, False)
        self.rest = b""

    def send(self, data):
        while data:
            try:
                data = data[os.write(self.file, data):]
            except BlockingIOError:
                time.sleep(0.001)

    def lines(self):
        """What has come, by whole lines."""
        try:
            self.rest += os.read(self.file, 4096)
        except BlockingIOError:
            time.sleep(0.001)
        *whole, self.rest = self.rest.split(b"\r\n")
        return whole

    def wait_for(self, begins):
        until = time.monotonic() + PATIENCE_S
        while time.monotonic() < until:
            for line in self.lines():
                if line.startswith(begins):
                    return line
        sys.exit(f"{begins!r} did not come")


def main(name, path):
    port = Port(name)
    port.wait_for(b"Grbl 1.1")
    with open(path, "rb") as file:
        left = collections.deque(file.read().splitlines(keepends=True))
    unanswered, most, count, until = collections.deque(), 0, len(left), time.monotonic() + PATIENCE_S
    while left or unanswered:
        while left and sum(map(len, unanswered)) + len(left[0]) <= BUFFER:
            port.send(left[0])
            unanswered.append(left.popleft())
        most = max(most, len(unanswered))
        for answer in port.lines():
            if answer == b"ok":
                unanswered.popleft()
                until = time.monotonic() + PATIENCE_S
            elif answer:
                sys.exit(f"{unanswered[0]!r}: {answer!r}")
        if time.monotonic() > until:
            sys.exit(f"no answer to {unanswered[0]!r}")
    port.send(b"G4 P0\n")  # answered when all is done
    port.wait_for(b"ok")
    port.send(b"?")
    told = port.wait_for(b"<").decode()
    if not told.startswith("<Idle|MPos:0.000,0.000,"):
        sys.exit(f"it should be idle at its origin: {told}")
    print(f"  {count} lines, up to {most} of them unanswered; then {told}")


if __name__ == "__main__":
    main(*sys.argv[1:])
