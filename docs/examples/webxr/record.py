"""record.py FRAMES.h5: the targets of a run's first hand as a headset would see them, 20 a second, on standard output: the 25 joints of
WebXR's XRHand, each a position [m] and a quaternion x y z w, y up. joints.json is

    ./zwang simulate box --motion lift --verify 0 --out lift
    python3 docs/examples/webxr/record.py lift/frames.h5 > docs/examples/webxr/joints.json
"""
import json, sys
import h5py
from joints import bones, turned

fingers = [("thumb", "phalanx-proximal", "phalanx-distal")]
fingers += [(f"{name}-finger", "phalanx-proximal", "phalanx-intermediate", "phalanx-distal") for name in ("index", "middle", "ring", "pinky")]
names = ["wrist", *(f"{finger}-{joint}" for finger, *parts in fingers for joint in ("metacarpal", *parts, "tip"))]


def joints_of(poses):
    """The joints of 16 target poses. Where the model has no joint, wrist and metacarpals of the fingers are put into the palm."""
    palm, turn = poses[0][:3], poses[0][3:]
    place = lambda at: [a + b for a, b in zip(palm, turned(turn, at))]
    joints = [(place((0, -0.048, 0)), turn)]
    for finger in range(5):
        if finger > 0:
            joints.append((place((0.02 * finger - 0.047, -0.03, 0)), turn))
        for k in range(3 * finger, 3 * finger + 3):
            half = turned(poses[1 + k][3:], (0, bones["phalanxes"][k][0] / 2, 0))
            joints.append(([a - b for a, b in zip(poses[1 + k], half)], poses[1 + k][3:]))
        joints.append(([a + b for a, b in zip(poses[1 + k], half)], poses[1 + k][3:]))
    return [round(number, digits) for (x, y, z), (a, b, c, w) in joints
            for number, digits in ((x, 4), (z, 4), (-y, 4), (a, 3), (c, 3), (-b, 3), (w, 3))]  # y is up


if __name__ == "__main__":
    with h5py.File(sys.argv[1]) as run:
        every = round(0.05 / (run["t"][1] - run["t"][0]))
        targets = run["target"][::every, :16]
    for before, after in zip(targets, targets[1:]):  # of the two quaternions of a rotation the one near that of the frame before
        after[(before[:, 3:] * after[:, 3:]).sum(axis=1) < 0, 3:] *= -1
    frames = [joints_of(poses.tolist()) for poses in targets]
    json.dump({"joints": names, "rate": 20, "frames": frames}, sys.stdout, separators=(",", ":"))
    print()
