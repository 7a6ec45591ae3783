#!/usr/bin/env python3
"""Writes the drawing that every sender sends: G-code for a pen that M3 lowers and M5 lifts.

    drawing.py FILE

A rosette of short lines, a spiral, hatching, squares within each other and circles as arcs: long lines and
short ones, corners of all kinds, and many lifts of the pen. Some 480 lines, which a sender has to keep more of
on the way than Grbl's receive buffer holds. The same bytes wherever it runs: all places are rounded to 1 um.
"""
import math
import sys

FEED_MM_MIN = 2700  # 45 mm/s, the stepper plotter's own speed with the pen down


def stroke(points):
    (x, y), *rest = points
    yield "M5"
    yield f"G0 X{x:.3f} Y{y:.3f}"
    yield "M3 S90"
    for x, y in rest:
        yield f"G1 X{x:.3f} Y{y:.3f}"


def rosette(x, y, radius, petals, count):
    for n in range(count + 1):
        angle = 2 * math.pi * n / count
        r = radius * (0.6 + 0.4 * math.cos(petals * angle))
        yield x + r * math.cos(angle), y + r * math.sin(angle)


def spiral(x, y, pitch, turns, count):
    for n in range(count + 1):
        angle = 2 * math.pi * turns * n / count
        r = pitch * angle / (2 * math.pi)
        yield x + r * math.cos(angle), y + r * math.sin(angle)


def hatching(x, y, width, height, count):
    for n in range(count):
        ends = [(x, y + height * n / (count - 1)), (x + width, y + height * n / (count - 1))]
        yield from ends if n % 2 == 0 else reversed(ends)


def square(x, y, half):
    return [(x - half, y - half), (x + half, y - half), (x + half, y + half), (x - half, y + half), (x - half, y - half)]


def lines():
    yield from ["G21", "G90", f"F{FEED_MM_MIN}"]
    yield from stroke(rosette(35, 35, 24, 7, 180))
    yield from stroke(spiral(95, 35, 2.5, 9, 170))
    yield from stroke(hatching(12, 75, 40, 18, 22))
    for half in range(3, 27, 3):
        yield from stroke(square(95, 95, half))
    for radius in range(6, 22, 5):
        yield from stroke([(150 + radius, 35)])
        yield f"G2 X{150 - radius:.3f} Y35.000 I{-radius:.3f} J0.000"
        yield f"G2 X{150 + radius:.3f} Y35.000 I{radius:.3f} J0.000"
    yield from ["M5", "G0 X0.000 Y0.000"]


if __name__ == "__main__":
    text = list(lines())
    with open(sys.argv[1], "w", encoding="ascii", newline="\n") as out:
        out.write("\n".join(text) + "\n")
    print(f"{len(text)} lines of G-code")
