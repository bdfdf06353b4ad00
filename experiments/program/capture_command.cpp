#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include <zwang/bench/capture/capture.h>
#include <zwang/bench/program/commands.h>
#include <zwang/bench/program/options.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/problem/wording.h>
#include <zwang/core/process/isolated.h>
#include <zwang/experiments/program/commands.h>

namespace zwang {
namespace {

struct Captured {
  long problems = 0, unknowns = 0, fewest_rows = 0, most_rows = 0;
};

#ifdef ZWANG_HAS_MUJOCO

// MuJoCo may end a process over a damaged model: it runs in one of its own, which writes a file a problem.
Captured captured_apart(const CaptureOptions& options, const std::filesystem::path& out) {
  std::filesystem::create_directories(out);
  const IsolationLimits limits{.seconds = 1e5, .bytes = std::size_t{8} << 30};
  const std::string answer = isolated(options.model, limits, [&] {
    Captured total;
    capture(options, [&](int step, const Instance& instance) {
      write_problem(out / printed("step-%06d.h5", step), instance);
      const auto rows = static_cast<long>(instance.problem.rows());
      total.unknowns = static_cast<long>(instance.problem.size());
      total.fewest_rows = total.problems == 0 ? rows : std::min(total.fewest_rows, rows);
      total.most_rows = std::max(total.most_rows, rows);
      ++total.problems;
    });
    return std::string(reinterpret_cast<const char*>(&total), sizeof total);
  });
  Captured total;
  std::memcpy(&total, answer.data(), std::min(sizeof total, answer.size()));
  return total;
}

#else

Captured captured_apart(const CaptureOptions&, const std::filesystem::path&) {
  throw std::invalid_argument(
      "capture needs MuJoCo, which was not there at the build: install libmujoco-dev, build anew");
}

#endif

}  // namespace

int capture_command(std::vector<std::string> words) {
  CLI::App options("Steps an MJCF or URDF model with MuJoCo and writes the contact problem of each step.");
  introduce(options, "capture",
            "  ./zwang capture humanoid.xml --steps 500 --out humanoid\n"
            "  ./zwang bench --problems humanoid --solvers dual_active_set,newton,ipopt");
  CaptureOptions capture;
  std::string model, out;
  options.add_option("MODEL", model, "MJCF or URDF, read by MuJoCo's own loader")->type_name("FILE")->required();
  within(from_to(1, 1e7), options.add_option("--steps", capture.steps, "of the model's own length"))
      ->capture_default_str();
  within(from_to(1, 1e7), options.add_option("--every", capture.every, "one problem in so many steps"))
      ->capture_default_str();
  options.add_flag("--friction", capture.friction, "contacts have the model's friction: tangent rows, Coulomb's law");
  options.add_option("--out", out, "a folder for the problems, a file each")->type_name("DIR")->required();
  if (!read(options, std::move(words))) return done;
  capture.model = model;
  if (std::filesystem::exists(out) && !std::filesystem::is_empty(out))
    throw std::invalid_argument("--out " + out + ": expected a folder that is new or empty");
  const Captured total = captured_apart(capture, out);
  std::printf(
      "%ld problems of %ld unknowns and %ld to %ld rows -> %s\nSolve them: ./zwang bench --problems %s --solvers "
      "dual_active_set,newton%s\n",
      total.problems, total.unknowns, total.fewest_rows, total.most_rows, out.c_str(), out.c_str(),
      capture.friction ? " --law pyramid" : "");
  return done;
}

}  // namespace zwang
