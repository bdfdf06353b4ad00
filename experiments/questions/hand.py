"""`./zwang hand --matrix`: the sparsity of the problem of one pressed hand.

The program holds this text (held.py), and is asked for the entries of J.
"""
import argparse
import itertools
import json
import subprocess
import sys

WRONG_USE = 2
PLURALS = {"universal_joint": "universal joints", "revolute_joint": "revolute joints", "joint_limit": "limits"}
BLOCKS = " ▘▝▀▖▌▞▛▗▚▐▜▄▙▟█"  # two rows and two columns a character


class Options(argparse.ArgumentParser):
    def error(self, message):
        print(f"{message.removeprefix('argument ')} (./zwang hand --help)", file=sys.stderr)
        sys.exit(WRONG_USE)


def up_to(most):
    def read(text):
        if not text.isdecimal() or int(text) > most:
            raise argparse.ArgumentTypeError(f"{text} should be a number from 0 to {most}")
        return text
    return read


def draw(rows, columns):
    print(" " * 20 + "p   " + "".join(f"{name:10}" for name in ("thumb", "index", "middle", "ring", "little")))
    for kind, group in itertools.groupby(rows, key=lambda row: row[0]):  # rows of one constraint type lie together
        entries = [set(at) for _, at in group]
        label = f"{PLURALS.get(kind, 'contacts')} {len(entries)}"
        for pair in itertools.zip_longest(entries[::2], entries[1::2], fillvalue=set()):
            cells = (BLOCKS[sum(bit for bit, row, at in zip((1, 2, 4, 8), (0, 0, 1, 1), (j, j + 1, j, j + 1)) if at in pair[row])]
                     for j in range(0, columns, 2))
            print(f"{label:20}" + "".join(" " * (j % 9 == 3 and j > 0) + cell for j, cell in enumerate(cells)))
            label = ""


def main(program, *words):
    options = Options(
        prog="./zwang hand", usage="./zwang hand [OPTIONS]", allow_abbrev=False,
        formatter_class=lambda prog: argparse.RawDescriptionHelpFormatter(prog, max_help_position=34, width=100),
        description="The problem of one pressed hand: 16 bodies, 70 joint rows, violated limits, contacts.",
        epilog="""Examples:
  ./zwang hand --matrix
  ./zwang hand --matrix --contacts 40""")
    options.add_argument("--matrix", action="store_true", help="draw the sparsity of J, (70 + limits + contacts) x 96")
    options.add_argument("--contacts", type=up_to(60), default="24", metavar="N", help="contact rows; from 0 to 60; default: 24")
    options.add_argument("--limits", type=up_to(20), default="6", metavar="N", help="violated limits; from 0 to 20; default: 6")
    asked = options.parse_args(words)
    if not asked.matrix:
        options.error("what of the hand? --matrix draws its sparsity")
    answered = subprocess.run([program, "experiment", ":hand", asked.contacts, asked.limits], stdout=subprocess.PIPE)
    if answered.returncode:
        return answered.returncode
    hand = json.loads(answered.stdout)
    rows, columns = hand["rows"], hand["unknowns"]
    draw(rows, columns)
    entries = hand["entries"]
    print(f"J is {len(rows)} x {columns} with {entries} entries that are not zero: {100 * entries / (len(rows) * columns):.1f} %")
    return 0
