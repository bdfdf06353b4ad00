"""Fixed points and extragradients of the variational inequality of Coulomb's law, in NumPy, for a family that is not built in.

r <- P(r - rho F(r)) with F(r) = W r + q + mu |u_t| e_n, u = W r + q, P the projection on the cones. The steps rho are one, or adapt
themselves: rho is divided until rho |F(r) - F(r')| <= L |r - r'| (rule 1: Khobotov's), or until rho (r - r')'(F(r) - F(r')) <= L |r - r'|^2 (rule 2),
and grows where the left side is small. They stop as the report's solvers do: |r - P(r - F(r))| <= tolerance |q|.
"""
import json
import time

import numpy as np

import files

RULES = {"vi_fixed_step": (False, 0), "vi_fixed_point": (False, 1), "vi_fixed_point_2": (False, 2), "vi_extragradient": (True, 1), "vi_extragradient_2": (True, 2)}
SHRINK, GROW, ENOUGH, LITTLE = 2 / 3, 3 / 2, 0.9, 0.3  # of rho; L and the share of it below which rho grows
ROWS = 1000          # beyond, W is not formed
STEPS = 100_000


class Inequality:
    def __init__(self, problem, z_u):
        self.pull = np.linalg.solve(problem.M, problem.J.T)
        self.W, self.q = problem.J @ self.pull, problem.J @ z_u - problem.c
        self.z_u, self.mu = z_u, np.array(problem.mu)
        self.normal = np.array([c[0] for c in problem.contacts])
        self.tangents = [np.array([c[1 + t] for c in problem.contacts]) for t in range(len(problem.contacts[0]) - 1)]
        self.products = 0

    def force(self, r):
        self.products += 1
        u = self.W @ r + self.q
        u[self.normal] += self.mu * np.sqrt(sum((u[t]**2 for t in self.tangents), np.zeros(len(self.normal))))
        return u

    def project(self, x):
        n, slip = x[self.normal], np.sqrt(sum((x[t]**2 for t in self.tangents), np.zeros(len(self.normal))))
        inside, polar = slip <= self.mu * n, self.mu * slip <= -n
        on = (n + self.mu * slip) / (1 + self.mu**2)
        out = np.zeros_like(x)
        out[self.normal] = np.where(inside, n, np.where(polar, 0, on))
        share = np.where(inside, 1, np.where(polar, 0, self.mu * on / np.where(slip > 0, slip, 1)))
        for t in self.tangents:
            out[t] = share * x[t]
        return out

    def solve(self, tolerance, seconds, extragradient, rule):
        """(status, r)"""
        started, rho, r = time.process_time(), 1.0, np.zeros(len(self.q))
        F, mark = self.force(r), tolerance * np.linalg.norm(self.q)
        for _ in range(STEPS):
            if not np.isfinite(F).all():
                return "numerical failure", r
            if np.linalg.norm(r - self.project(r - F)) <= mark:
                return "solved", r
            if time.process_time() - started > seconds:
                return "time limit", r
            while True:
                new = self.project(r - rho * F)
                F_new, step = self.force(new), np.linalg.norm(r - new)
                if not rule or not step:
                    break
                least = rho * (np.linalg.norm(F - F_new) / step if rule == 1 else (r - new) @ (F - F_new) / step**2)
                if least <= ENOUGH:
                    break
                rho *= SHRINK * min(1, 1 / least)
            r, F = (moved := self.project(r - rho * F_new), self.force(moved)) if extragradient else (new, F_new)
            if rule and step and least < LITTLE:
                rho *= GROW
        return "iteration limit", r


def answers(folder, rows, tolerances, seconds):
    """Writes folder/pack of the run's problems under Coulomb's law, and a file of answers a rule and tolerance. Returns these files."""
    pack = folder / "pack"
    pack.mkdir(parents=True, exist_ok=True)
    unique = {row["problem_sha256"]: row for row in rows if row["m"] <= ROWS and not row["equalities"]}
    problems = []
    for sha, row in unique.items():
        (pack / "problems").mkdir(exist_ok=True)
        path = pack / "problems" / f"{len(problems):04}.h5"
        path.write_bytes(row["problem_file"].read_bytes())
        problems.append({"file": f"problems/{path.name}", "sha256": sha, "name": row["problem"], "family": row["family"], "law": "coulomb", "n": row["n"], "m": row["m"],
                         "equalities": 0, "known": "nothing", "method": ""})
    (pack / "pack.json").write_text(json.dumps({"zwang_pack": 1, "made_by": "", "problems": problems}))
    written = []
    for tolerance in tolerances:
        for name, (extragradient, rule) in RULES.items():
            written.append(folder / f"{name}_{tolerance:g}.jsonl")
            with open(written[-1], "w") as out, np.errstate(all="ignore"):
                print(json.dumps({"zwang_answers": 1, "solver": name, "tolerance": tolerance}), file=out)
                for index in problems:
                    problem = files.read(pack / index["file"])
                    if len({len(c) for c in problem.contacts}) != 1 or len(problem.J) != index["m"]:
                        continue
                    vi = Inequality(problem, problem.z_u)
                    started = time.process_time()
                    status, r = vi.solve(tolerance, seconds, extragradient, rule)
                    answer = {"sha256": index["sha256"], "status": status, "iterations": vi.products, "seconds": time.process_time() - started}
                    if np.isfinite(r).all():
                        answer["z"] = (vi.z_u + vi.pull @ r).tolist()
                    print(json.dumps(answer), file=out)
    return pack, written
