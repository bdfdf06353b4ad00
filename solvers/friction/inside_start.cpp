#include <zwang/solvers/friction/cone_starts.h>
#include <zwang/solvers/newton_start.h>

namespace zwang {

NewtonStart::Run inside_start() {
  using enum NewtonStart::End;
  return [starts = ConeStarts()](const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                 Solution& s) mutable {
    SolveOptions rough = options;
    rough.tolerance = tolerances::newton_inside;
    rough.accuracy = rough.speed_accuracy = 0;  // the polish promises for less
    const ConeStarts::Job job{p, rough, deadline, s, starts.best, false};
    try {
      if (!starts.begin(job, ConeProgram::Want::normals)) return written;
    } catch (const Stopped&) {
      return failed;  // no room for a factor beside that of the method, which goes on alone; or no time
    }
    const ConeStarts::End end = starts.from_inside(job, ConeStarts::first_start);
    if (end == ConeStarts::End::written) return written;
    if (end == ConeStarts::End::failed) return failed;
    starts.program().write(p, starts.best.v, starts.best.y, s);
    if (end == ConeStarts::End::accepted) return near;
    s.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
    return limit;
  };
}

}  // namespace zwang
