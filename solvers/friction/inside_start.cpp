#include <zwang/solvers/friction/cone_starts.h>

namespace zwang {

NewtonStart::Run inside_start() {
  return [starts = ConeStarts()](const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                 Solution& s) mutable {
    SolveOptions rough = options;
    rough.tolerance = tolerances::newton_inside;
    rough.accuracy = rough.speed_accuracy = 0;  // the polish promises for less
    const ConeStarts::Job job{p, rough, deadline, s, starts.best, false};
    try {
      if (!starts.begin(job, ConeProgram::Want::normals)) return NewtonStart::End::written;
    } catch (const Stopped&) {  // no room for a factor beside that of the method, which goes on alone; or no time
      return NewtonStart::End::failed;
    }
    const NewtonStart::End end = starts.from_inside(job, ConeStarts::first_start);
    if (end == NewtonStart::End::written || end == NewtonStart::End::failed) return end;
    starts.program().write(p, starts.best.v, starts.best.y, s);
    if (end == NewtonStart::End::limit) s.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
    return end;
  };
}

}  // namespace zwang
