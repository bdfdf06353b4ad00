#include <zwang/solvers/newton/inside_start.h>

#include <zwang/solvers/friction/cone_starts.h>

namespace zwang {

InsideStart::InsideStart() : starts_(std::make_unique<ConeStarts>()) {}
InsideStart::InsideStart(const InsideStart&) : InsideStart() {}
InsideStart::~InsideStart() = default;

InsideStart::End InsideStart::run(const Problem& p, const SolveOptions& options, const Deadline& deadline,
                                  Solution& s) {
  SolveOptions rough = options;
  rough.tolerance = tolerances::newton_inside;
  rough.accuracy = rough.speed_accuracy = 0;  // the polish promises for less
  const ConeStarts::Job job{p, rough, deadline, s, starts_->best, false};
  try {
    if (!starts_->begin(job, ConeProgram::Want::normals)) return End::written;
  } catch (const Stopped&) {
    return End::failed;  // no room for a factor beside that of the method, which goes on alone; or no time
  }
  starts_->best.natural = infinity;
  const ConeStarts::End end = starts_->from_inside(job, ConeStarts::first_start);
  if (end == ConeStarts::End::written) return End::written;
  if (end == ConeStarts::End::failed) return End::failed;
  starts_->program().write(p, starts_->best.v, starts_->best.y, s);
  if (end == ConeStarts::End::accepted) return End::near;
  s.status = deadline.passed() ? Status::time_limit : Status::iteration_limit;
  return End::limit;
}

}  // namespace zwang
