"""Writes a run of a million synthetic records: the records of a small run over and over, with other problems' names and times.

Nothing in it was ever measured. Usage: synthetic_run.py SMALL_RUN PROBLEMS PARTS OUT
"""
import hashlib
import json
import os
import random
import sys
import zlib


def sealed(record):
    text = json.dumps(record, separators=(",", ":"), ensure_ascii=False)[:-1]
    return f'{text},"check":"{zlib.crc32(text.encode()):08x}"}}\n'


def write(small, problems, parts, out):
    with open(f"{small}/run.json") as file:
        record = json.load(file)
    with open(f"{small}/results.jsonl") as file:
        lines = [json.loads(line) for line in file]
    runs = len(record["solvers"]) * len(record["tolerances"])
    templates = [lines[i:i + runs] for i in range(0, len(lines), runs)]
    commit = record["commit"]
    record["problem_names"] = [f'{templates[i % len(templates)][0]["family"]}({i})' for i in range(problems)]
    record["problem_sha256"] = [templates[i % len(templates)][0]["problem_sha256"] for i in range(problems)]
    record["problems"] = problems
    record["runs"] = problems * runs
    chance = random.Random(1)
    for k in range(parts):
        folder = f"{out}/{k}"
        os.makedirs(f"{folder}/problems")
        record["options"]["shard"] = f"{k}/{parts}"
        with open(f"{folder}/run.json", "w") as file:
            json.dump(record, file)
        with open(f"{folder}/results.jsonl", "w") as file:
            for i in range(k, problems, parts):
                template = templates[i % len(templates)]
                name = f"problems/{i:04d}.h5"
                os.link(f'{small}/{template[0]["problem_file"]}', f"{folder}/{name}")
                for line in template:
                    line = dict(line)
                    del line["check"]
                    key = f'{commit}\n{name}\n{line["problem_sha256"]}\n{line["solver"]}\n{line["tolerance"]:.17g}'
                    line.update(problem=record["problem_names"][i], problem_file=name, batch=i,
                                cell=hashlib.sha256(key.encode()).hexdigest()[:32])
                    for column in ("z_error", "solve_s"):
                        if line[column]:
                            line[column] *= chance.uniform(0.5, 2)
                    file.write(sealed(line))


if __name__ == "__main__":
    write(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4])
