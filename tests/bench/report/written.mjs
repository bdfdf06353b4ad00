// The files that `zwang report` says it wrote.
import {execFileSync} from 'node:child_process';

export const written = (program, ...words) =>
  execFileSync(program, ['report', ...words], {encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe']}).trim().replace(/^Report: /, '').split('\n');
