// node make_results.mjs DIR [CASE]: a SYNTHETIC run folder for tests of the report. Nothing in it was ever measured.
// CASE: full (default), later (the same with other times and one more solver), crowd (16 solvers), atlas (stability families
// alone), laws (three classes of problems), large (more than 20,000 runs), speed, empty, one, undecided, torn.
import fs from 'node:fs';

const [dir, kind = 'full'] = process.argv.slice(2);
let seed = kind === 'later' ? 7 : 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
const noise = width => 10 ** (width * (random() - 0.5));

// name, foreign, floor of the error, time at n = 96 [s], exponent, growth of the time a decade of tolerance
const solvers = [
  ['nnls', false, 2e-15, 1e-4, 1.9, 1], ['nnls_paper', false, 5e-15, 1.4e-4, 2, 1], ['cholesky', false, 1e-14, 2.4e-4, 1.2, 1],
  ['dual_active_set', false, 5e-16, 2e-5, 1.6, 1], ['ipopt', true, 1e-10, 8e-3, 1.1, 1.05], ['nlopt:algorithm=slsqp', true, 1e-9, 2e-3, 2.6, 1],
  ['nlopt:algorithm=cobyla', true, 1e-4, 2e-2, 2.4, 1.2], ['pgs', false, 1e-6, 1e-5, 1.1, 2.4], ['apgd', false, 1e-9, 3e-5, 1.1, 1.6],
  ['bullet_dantzig', true, 1e-8, 4e-5, 2.1, 1], ['bullet_pgs', true, 1e-4, 8e-6, 1, 2.2],
];
if (kind === 'crowd')
  for (const name of ['newton', 'projected_gradient', 'nlopt:algorithm=mma', 'nlopt:algorithm=ccsaq', 'mujoco_newton']) solvers.push([name, false, 1e-7, 3e-4, 1.5, 1.3]);
const exact = ['nnls', 'nnls_paper', 'cholesky', 'dual_active_set'];
if (kind === 'later') solvers.push(['mine', false, 1e-13, 1.5e-5, 1.5, 1]);
const tolerances = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14];

const problems = [];
const add = (family, knob, values, make) => values.forEach(value =>
  problems.push({family, knob, knob_value: value, problem: `${family}(${knob}=${value})`, feasible: true, n: 60, m: 80, equalities: 0, ...make(value)}));
add('hand', 'contacts', [4, 8, 16, 32, 64, 128, 200], c => ({n: 96, m: 70 + c, equalities: 70, type: 'contact'}));
add('tower', 'boxes', [5, 10, 20, 40, 80], b => ({n: 6 * b, m: 4 * b}));
add('chain', 'links', [8, 32, 128, 512], b => ({n: 6 * b, m: 3 * b, equalities: 3 * b, type: 'ball_joint'}));
add('arch', 'stones', [7], b => ({n: 6 * b, m: 8 * b}));
add('random', 'rows', [20, 60, 120], m => ({m}));
add('MR', 'ratio', Array.from({length: 13}, (_, i) => 2 ** (4 * i)), () => ({hard: 1}));
add('NPE', 'eps', Array.from({length: 15}, (_, i) => 2 ** -(3 + 3 * i)), () => ({hard: 1.3, equalities: 2}));
add('LOOP', 'delta', [0, ...Array.from({length: 12}, (_, i) => 2 ** -(48 - 4 * i))].reverse(), () => ({n: 18, m: 20, hard: 1.2, equalities: 20}));
add('INC', 'delta', [...Array.from({length: 15}, (_, i) => 2 ** -(3 + 3 * i)), 0], delta => ({feasible: delta === 0, n: 6, m: 2, equalities: 2}));
add('WEAK', 'eps', [1, 2 ** -8, 2 ** -16, 2 ** -24, 2 ** -32, 2 ** -40, 0], () => ({hard: 0.7}));

if (kind === 'large')
  for (const p of [...problems])
    for (let copy = 1; copy < 5; ++copy) problems.push({...p, problem: `${p.problem} #${copy}`});

fs.mkdirSync(dir, {recursive: true});
const chosen_solvers = kind === 'one' ? solvers.slice(3, 4) : kind === 'empty' ? [] : solvers;
const stability = ['MR', 'NPE', 'LOOP', 'INC', 'WEAK'];
const under = law => problems.filter(p => ['hand', 'tower'].includes(p.family)).map(p => {
  const named = name => ['frictionless', 'coulomb'].includes(law) ? name : `${name} (${law})`;
  return {...p, law, family: named(p.family), problem: law === 'coulomb' ? `${p.problem} mu` : named(p.problem)};
});
const readers = {convex: ['apgd', 'pgs', 'ipopt'], coulomb: ['cholesky', 'bullet_pgs']};
const chosen_problems = kind === 'laws' ? ['frictionless', 'pyramid', 'convex', 'coulomb'].flatMap(under) : kind === 'one' ? problems.slice(3, 4) : kind === 'atlas' ? problems.filter(p => stability.includes(p.family)) : problems;
const lines = [], traces = [];
chosen_problems.forEach((p, at) => {
  const in_sweep = chosen_problems.filter(q => q.family === p.family).indexOf(p);
  for (const [solver, foreign, floor, time, exponent, growth] of chosen_solvers)
    tolerances.forEach((tolerance, rung) => {
      const {hard = 0, type = 'contact', ...about} = p;
      const condition = 10 ** (hard * in_sweep * (solver === 'dual_active_set' ? 0.6 : 1.1));
      const iterative = growth > 1;
      const range_gap = solver === 'nnls_paper' ? (p.family === 'hand' && p.knob_value >= 16 ? 4e-4 * p.knob_value * noise(0.4) : 1e-16 * noise(1)) : null;
      let error = Math.max(iterative ? tolerance * 0.4 * noise(1) : 0, floor * condition * noise(1.2), range_gap > 1e-10 ? 0.7 * range_gap : 0);
      let claimed = 'solved', seconds = time * (p.n * p.m / 8000) ** (exponent / 2) * growth ** rung * noise(0.2);
      if (iterative && error > 3 * tolerance) claimed = 'iteration limit';
      if (solver === 'ipopt' && p.equalities > p.n) claimed = 'numerical failure', error = null;
      if (solver.includes('cobyla') && p.n > 200) claimed = 'time limit', error = null, seconds = null;
      if (solver.startsWith('bullet') && p.equalities > 200) claimed = 'unsupported', error = null;
      if (solver === 'nnls' && error > 1e-3) claimed = 'solved, ill-conditioned';
      if (p.law in readers && !readers[p.law].includes(solver)) claimed = 'unsupported', error = seconds = null;
      const limit = Math.max(10 * tolerance, 1e-12);
      let verified = error === null ? (claimed === 'unsupported' ? 'unsupported' : claimed === 'time limit' ? 'timeout' : 'no answer')
        : error <= limit ? 'solved' : error <= 1000 * limit ? 'near' : 'wrong';
      if (!p.feasible) {
        const sees = p.knob_value > floor * 1e3;
        claimed = sees ? 'infeasible' : 'solved';
        verified = sees ? (solver === 'cholesky' ? 'infeasible, claimed only' : 'infeasible, proven') : 'wrong';
        error = null;
      }
      const undecided = kind === 'undecided';
      if (undecided) verified = 'undecided';
      lines.push({
        ...about, seed: 1, problem_sha256: `synthetic-${at}`, problem_file: `problems/${String(at).padStart(4, '0')}.h5`, solver, foreign, tolerance, claimed, verified,
        z_error: undecided ? null : error, z_bound: error === null ? null : 30 * error, bound_method: 'active set', bound_sigma_min: 0.1,
        primal: error === null ? null : error / 3, dual: 0, stationarity: error === null ? null : error / 5, complementarity: 1e-17, gap: error === null ? null : error * error,
        natural: error, scale: 9.8, farkas: null, setup_s: seconds && seconds / 3, solve_s: seconds, solve_s_q1: seconds && seconds * 0.95, solve_s_q3: seconds && seconds * 1.08, prepare_s: seconds && seconds * (foreign ? 0.3 : 0.1), repetitions: 9,
        iterations: iterative ? Math.round(10 * growth ** (2 * rung)) : Math.round(p.m / 2), reference: undecided ? null : p.n <= 200 ? 'mpfr 100 digits' : 'known answer',
        reference_bound: 1e-30, worst_row: `${type} 3 of body 2`, worst_by_type: error === null ? [] : [{type, violation: 9.8 * error / 3, relative: error / 3, row: `${type} 3 of body 2`}],
        rank: p.m, smallest_pivot: 0.1, largest_rejected_pivot: 0, redundant: 0, conflicting: [], fallback: false, range_gap, message: '', batch: at, kernel_s: 5e-5, allocations: 0,
      });
      if (kind === 'full' && [2, 8].includes(at) && rung === 6 && claimed !== 'unsupported')
        for (let k = 0; k <= (iterative ? 300 : 14); ++k) {
          const left = iterative ? Math.max(0.7 ** (k * (growth < 2 ? 0.6 : 0.15)), floor) : k < 14 ? 1 / (1 + 0.3 * k) : floor;
          traces.push({problem: p.problem, family: p.family, solver, iteration: k, time_s: time * (0.1 + k / 20), z_error: left * noise(0.1), primal: left / 3, stationarity: left / 7, gap: left * left});
        }
    });
});
if (kind === 'full')
  for (const at of [0, 2])
    lines.push({...lines.find(line => line.batch === at), solver: 'recorded:mujoco', tolerance: 1e-14, claimed: 'unsolved', verified: 'wrong', z_error: at ? 2e-3 : 4e-2,
                solve_s: null, solve_s_q1: null, solve_s_q3: null, setup_s: null, prepare_s: null});
const text = rows => rows.map(row => JSON.stringify(row) + '\n').join('');
fs.writeFileSync(`${dir}/results.jsonl`, kind === 'torn' ? text(lines).slice(0, -40) : text(lines));
if (traces.length) fs.writeFileSync(`${dir}/traces.jsonl`, text(traces));
if (kind === 'one') {
  const start = {frames: 9, checked: 1, right: 1, solve_s: 2e-5, iterations: 3, allocations: 0, worst_z_error: 1e-15};
  fs.writeFileSync(`${dir}/speed.jsonl`, text([{kind: 'sequence', sequence: 'hand', solver: chosen_solvers[0][0], cold: start, warm: {...start, solve_s: 1e-5}}]));
}
if (kind === 'speed')
  fs.writeFileSync(`${dir}/speed.jsonl`, text([{kind: 'assembly', scene: 'hand', contacts: 64, n: 96, m: 134, allocations: 0, assemble_s: 5e-6, islands_s: 4e-6, kernel_s: 5e-5}]));
fs.writeFileSync(`${dir}/run.json`, JSON.stringify({
  zwang: '0.1.0', suite: 'synthetic', command: './zwang bench (synthetic)', started: '2000-01-01T00:00:00Z', finished: null, seed: 1, commit: kind === 'later' ? 'feedface00000000' : 'cafebabe00000000', dirty: true,
  compiler: 'none', flags: '-O3', build_type: 'Release', cpu: 'synthetic', cores: 2, libraries: {Eigen: '3.4.0', Ipopt: '3.11.9'}, tolerances,
  solvers: chosen_solvers.map(([name, foreign]) => ({name, method: `the method of ${name}`, limits: '', foreign, exact: exact.includes(name)})), problems: chosen_problems.length,
  notes: ['Synthetic: no figure in this run was measured.'],
}));
