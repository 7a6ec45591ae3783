"""Writes the small recordings of logs/ beside it, with notes of what is in them, in the formats of the programs that record a
serial line: one whole, one that was cut, one with bytes lost. Run it in this folder.

The notes are reckoned here, from the definition of the bytes in docs/serial-protocol.md, by nothing that the tests test."""

import json

BYTE_US = 39.0625  # ten bits at 256,000 baud
STEP_US = 200  # from one count to the next
TARGETS = [(12, 12), (40, 12), (40, 30), (12, 30), (12, 12)]


def digits(place):
    return [place[axis] // 10**power % 10 for axis in (0, 1) for power in range(5)]


def session(lost=(), cut=None):
    """Events (time, side, byte) and notes; `lost` are counts, by their numbers, that the recorder missed."""
    events, notes, now = [], {"targets": [], "reached": [], "anomalies": []}, 0.0
    true, seen, known_off, counted = [0, 0], [0, 0], [0, 0], 0
    path = [[0, 0]]
    for target in TARGETS:
        for digit in digits(target):
            events.append((int(now), "H", digit))
            now += BYTE_US
        notes["targets"].append(list(target))
        now += STEP_US
        while tuple(true) != target:
            for axis, (more, less) in enumerate(((0x31, 0x32), (0x33, 0x34))):
                way = (target[axis] > true[axis]) - (target[axis] < true[axis])
                if way == 0:
                    continue
                true[axis] += way
                counted += 1
                if counted not in lost:
                    seen[axis] += way
                    path.append(list(seen))
                    events.append((int(now), "D", more if way > 0 else less))
                now += BYTE_US
            now += STEP_US
        events.append((int(now), "D", 0x2B))
        error = [seen[axis] - true[axis] for axis in (0, 1)]
        # What is new since the last time that both were compared.
        fresh = [error[axis] - known_off[axis] for axis in (0, 1)]
        if any(fresh):
            notes["anomalies"].append({"i": len(events) - 1, "kind": "reached_mismatch", "error": fresh})
        notes["reached"].append(
            {"t_us": int(now), "desired": list(target), "actual": list(seen), "error": error, "resync_error": fresh}
        )
        known_off = error
        now += 1000
    if cut is not None:
        # The recorder is killed within a target that has no answer.
        for digit in digits((40, 41))[:cut]:
            events.append((int(now), "H", digit))
            now += BYTE_US
        notes["anomalies"].append({"i": len(events), "kind": "partial_target_at_end", "digits": digits((40, 41))[:cut]})
    notes |= {"events": len(events), "final_actual": seen, "final_resynced": true, "actual_polyline": path}
    return events, notes


def raw(name, events, tail=""):
    lines = [f"{time},{side},{byte:02x}" for time, side, byte in events]
    return f"# plotter-raw/1 name={name} baud=256000 clock=host-monotonic unit=us\n" + "\n".join(lines) + "\n" + tail


def socat(events):
    """As `socat -x -v` writes it: bytes that came together, with the time of their reading."""
    lines, position = [], {"H": 0, "D": 0}
    for time, side, byte in events:
        at = position[side]
        position[side] += 1
        sign = ">" if side == "H" else "<"
        lines.append(f"{sign} 2026/02/03 04:05:{6 + time // 1_000_000:02d}.{time % 1_000_000:06d}500  length=1 from={at} to={at}")
        letter = chr(byte) if 32 <= byte < 127 else "."
        lines += [f" {byte:02x}" + " " * 46 + f"  {letter}", "--"]
    return "\n".join(lines) + "\n"


def sigrok(events, side):
    """As `sigrok-cli` prints its decoder of a UART, at 2.56 MHz: the capture begins within the first byte, which is lost."""
    times = [(round(time * 2.56) + 9, byte) for time, of, byte in events[1:] if of == side]
    return "".join(f"{begin}-{begin + 80} uart-1: {byte:02x}\n" for begin, byte in times)


def main():
    def write(name, text):
        open(f"logs/{name}", "w", newline="\n").write(text)

    def noted(name, notes):
        write(f"{name}.json", json.dumps(notes) + "\n")

    events, _ = session()
    write("whole.csv", raw("whole", events))
    write("whole.socat.txt", socat(events))
    write("whole.uart_H.txt", sigrok(events, "H"))
    write("whole.uart_D.txt", sigrok(events, "D"))
    events, notes = session(cut=7)
    write("cut.csv", raw("cut", events, tail=f"{events[-1][0] + 39},H,"))
    noted("cut", notes)
    events, notes = session(lost=(30, 31, 60))
    write("lost.csv", raw("lost", events))
    noted("lost", notes)


main()
