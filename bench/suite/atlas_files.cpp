#include <zwang/bench/suite/atlas_files.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include <zwang/bench/references/reference.h>
#include <zwang/bench/suite/plan.h>

namespace zwang {
namespace {

// "GAP(k=3,feasible=1)" -> "GAP_k=3_feasible=1.h5".
std::string file_name(std::string problem) {
  for (char& c : problem)
    if (c == '(' || c == ',') c = '_';
  std::erase(problem, ')');
  return problem + ".h5";
}

std::string line_of(const Instance& i, const std::string& file) {
  const Problem& p = i.problem;
  const Reference& r = *i.reference;
  std::ostringstream line;
  line.precision(12);
  line << file << '\t' << p.name << '\t' << p.size() << '\t' << p.rows() << '\t' << problem_sha256(p) << '\t'
       << (r.feasible ? "yes" : "no") << '\t' << r.method << '\t' << r.bound << '\t';
  if (r.feasible) {
    using Wide = VectorX<long double>;
    const Wide z = r.z.cast<long double>();
    line << static_cast<double>(std::sqrt(z.dot(Wide(p.M.cast<long double>() * z))));
  } else {
    line << '-';
  }
  return line.str();
}

}  // namespace

std::size_t write_atlas(const std::filesystem::path& directory, const std::string& families,
                        const std::filesystem::path& cache,
                        const std::function<void(std::size_t, std::size_t, const std::string&)>& progress) {
  std::vector<Instance> points = make_plan({.suite = "atlas", .families = families, .solvers = "nnls"}).instances;
  std::filesystem::create_directories(directory);
  std::ofstream index(directory / "atlas.tsv");
  index << "file\tproblem\tn\tm\tsha256\tfeasible\tmethod\tbound\tlength of z\n";
  for (std::size_t k = 0; k < points.size(); ++k) {
    Instance& point = points[k];
    progress(k, points.size(), point.problem.name);
    const FoundReference found = reference_for(point, cache, {.second_witness = true});
    if (!found.reference) throw std::runtime_error(point.problem.name + ": " + found.note);
    point.reference = found.reference;
    const std::string file = file_name(point.problem.name);
    write_problem(directory / file, point);
    index << line_of(point, file) << '\n' << std::flush;
    if (!index) throw BadFile((directory / "atlas.tsv").string() + ": cannot be written");
  }
  return points.size();
}

}  // namespace zwang
