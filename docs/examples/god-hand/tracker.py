"""tracker.py FILE.csv: two seconds of a hand as zwang reads it. Put your tracker's numbers where the formulas are."""
import csv, math, sys

fingers = ["index", "middle", "ring", "little"]
angles = ["thumb_CMC_flexion", "thumb_CMC_abduction", "thumb_MCP", "thumb_IP"]
angles += [f"{finger}_{joint}" for finger in fingers for joint in ("MCP_flexion", "MCP_abduction", "PIP", "DIP")]
with open(sys.argv[1], "w", newline="") as file:
    table = csv.writer(file)
    table.writerow(["time", "palm_x", "palm_y", "palm_z", "palm_qw", "palm_qx", "palm_qy", "palm_qz", *angles])
    for frame in range(181):
        t = frame / 90  # s
        down = 0.5 - 0.5 * math.cos(math.pi * t)  # 0, 1, 0 again
        palm = [0, 0, 0.15 - 0.1 * down]  # m, z up
        turn = [1, 0, 0, 0]  # w x y z: fingers along y, the palm looks down
        bent = [0 if "abduction" in name else 0.2 + 0.6 * down for name in angles]  # rad
        table.writerow([t, *palm, *turn, *bent])
