"""Writes the small drawings of gcode/ and hpgl/ beside it, in the manner of programs that people use. Run it in this folder.

The tests read them always, and files of others besides where PLOTTER_REAL_FILES names a folder of them."""

from math import atan2, ceil, cos, hypot, pi, sin


def star(points, radius, x, y):
    """The corners of a closed star, mm."""
    ways = [(radius if i % 2 == 0 else 0.4 * radius, pi * i / points) for i in range(2 * points + 1)]
    return [(x + r * cos(a), y + r * sin(a)) for r, a in ways]


def unicorn(strokes):
    """G-code as Inkscape's extension for the MakerBot Unicorn writes it, with its test of the pen."""
    lines = ["(a drawing of stars)", "G21 (metric)", "G90 (absolute mode)", "G92 X0.00 Y0.00 Z0.00 (you are here)", ""]
    lines += ["M300 S30 (pen down)", "G4 P150 (wait 150ms)", "M300 S50 (pen up)", "G4 P150 (wait 150ms)"]
    lines += ["M18 (disengage drives)", "M01 (Was registration test successful?)", "M17 (engage drives if YES, and continue)", ""]
    for stroke in strokes:
        (x, y), *rest = stroke
        lines += [f"G1 X{x:.2f} Y{y:.2f} F3500.00", "M300 S30.00 (pen down)", "G4 P150 (wait 150ms)"]
        lines += [f"G1 X{x:.2f} Y{y:.2f} F3500.00" for x, y in rest]
        lines += ["M300 S50.00 (pen up)", "G4 P150 (wait 150ms)", ""]
    lines += ["(end of print job)", "M300 S50.00 (pen up)", "G4 P150 (wait 150ms)", "M300 S255 (turn off servo)", "G1 X0 Y0 F3500.00"]
    lines += ["G1 Z0.00 F150.00 (go up to finished level)", "M18 (drives off)"]
    return "\n".join(lines) + "\n"


# Arcs of 60 degrees up and down: from, to, centre and the sign of the turn.
def waves():
    radius, x = 10.0, 10.0
    for i in range(8):
        up = i % 2 == 0
        yield (x, 20.0), (x + radius, 20.0), (x + radius / 2, 20.0 + (-1 if up else 1) * radius * 0.75**0.5), -1 if up else 1
        x += radius


HEAD = ["G90;comment glued to the word", "G21", "M5", "G0 X10.000 Y20.000", "M3"]
TAIL = ["M5", "G0 X0.000 Y0.000"]


def in_arcs():
    lines = []
    for begin, end, centre, turn in waves():
        lines.append(f"{'G3' if turn > 0 else 'G2'} X{end[0]:.3f} Y{end[1]:.3f} R10.000 F3000")
    return "\n".join(HEAD + lines + TAIL) + "\n"


def in_chords(sagitta_mm):
    lines = []
    for begin, end, centre, turn in waves():
        a = atan2(begin[1] - centre[1], begin[0] - centre[0])
        b = atan2(end[1] - centre[1], end[0] - centre[0])
        sweep = (b - a) % (2 * pi) * 1 if turn > 0 else -((a - b) % (2 * pi))
        radius = hypot(begin[0] - centre[0], begin[1] - centre[1])
        count = ceil(abs(sweep) / (8 * sagitta_mm / radius) ** 0.5)
        for i in range(1, count + 1):
            way = a + sweep * i / count
            lines.append(f"G1 X{centre[0] + radius * cos(way):.3f} Y{centre[1] + radius * sin(way):.3f} F3000")
    return "\n".join(HEAD + lines + TAIL) + "\n"


def plan():
    """HPGL with labels, relative movements and absolute ones, as programs for the HP 7475A write it; how many lines it draws."""
    text, count = ["IN;DF;PS4;SP1;"], 0
    for i in range(5):
        text.append(f"PU{400 + 1500 * i},800;PD{1600 + 1500 * i},800,{1600 + 1500 * i},2000,{400 + 1500 * i},2000,{400 + 1500 * i},800;")
        text.append(f"PU{500 + 1500 * i},1000;LBroom {i + 1}\x03PU;")
        count += 4
    text.append("PA1000,4000;PR;PD;")
    for i in range(60):
        text.append(f"PA{1000 + 100 * (i + 1)},{round(4000 + 900 * sin(0.3 * (i + 1)))};PR;")
        count += 1
    text.append("PA;PU11040,7721;SP0;IN;\n")
    return "\n".join(text), count


def main():
    strokes = [star(5, 8.0, 20, 20), star(7, 6.0, 45, 22), star(6, 9.0, 30, 42), star(4, 3.0, 52, 44)]
    open("gcode/stars.gcode", "w").write(unicorn(strokes))
    open("gcode/waves.gcode", "w").write(in_chords(0.002))
    open("gcode/waves_arcs.gcode", "w").write(in_arcs())
    text, count = plan()
    open("hpgl/plan.plt", "w", newline="").write(text)
    print(f"hpgl/plan.plt draws {count} lines beside its labels")


main()
