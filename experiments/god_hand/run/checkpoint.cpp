#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include <zwang/experiments/god_hand/step/simulation_state.h>

// A checkpoint is a line of numbers: doubles in hexadecimal, so that they come back to the bit.

namespace zwang::god {
namespace {

class Writer {
 public:
  void operator()(double x) {
    char text[32];
    std::snprintf(text, sizeof text, "%a ", x);
    out += text;
  }
  template <int Rows, int Columns>
  void operator()(const Eigen::Matrix<double, Rows, Columns>& m) {
    for (const double x : m.reshaped()) (*this)(x);
  }
  void operator()(const Pose<double>& pose) { (*this)(pose.position), (*this)(pose.rotation); }
  template <class T>
  void operator()(const std::vector<T>& all) {
    for (const T& one : all) (*this)(one);
  }
  std::string out = "1 ";  // version
};

// Reads into what is there, which has the right size already.
class Reader {
 public:
  explicit Reader(const std::string& text) : at_(text.c_str()) {
    double version;
    (*this)(version);
    if (version != 1) fail();
  }
  void operator()(double& x) {
    char* end;
    x = std::strtod(at_, &end);
    if (end == at_) fail();
    at_ = end;
  }
  template <int Rows, int Columns>
  void operator()(Eigen::Matrix<double, Rows, Columns>& m) {
    for (double& x : m.reshaped()) (*this)(x);
  }
  void operator()(Pose<double>& pose) { (*this)(pose.position), (*this)(pose.rotation); }
  template <class T>
  void operator()(std::vector<T>& all) {
    for (T& one : all) (*this)(one);
  }
  void end() const {
    if (std::string_view(at_).find_first_not_of(' ') != std::string_view::npos) fail();
  }

 private:
  [[noreturn]] static void fail() { throw std::runtime_error("not a checkpoint of this simulation"); }
  const char* at_;
};

}  // namespace

std::string Simulation::checkpoint() {
  State& s = *state_;
  Writer write;
  write(static_cast<double>(s.number));
  write(s.target);
  for (const Cluster& c : s.clusters) {
    const Cluster::Memory m = c.memory();
    write(m.pose), write(m.target), write(m.last_way), write(m.blocked ? 1.0 : 0.0), write(m.bent ? 1.0 : 0.0),
        write(m.caution);
  }
  const Coupling::Memory coupled = s.coupling->memory();
  write(coupled.hand_speed), write(coupled.wrench);
  const Measures::Memory& seen = s.measures->memory();
  for (int k = 0; k < 2; ++k) write(seen.god[k]), write(seen.target[k]);
  write(s.object);
  for (std::size_t o = 0; s.physics && o < s.object.size(); ++o)
    if (s.surroundings.objects[o].loose()) write(s.physics->pose(o)), write(s.physics->velocity(o));
  restore(write.out);
  return write.out;
}

void Simulation::restore(const std::string& checkpoint) {
  State& s = *state_;
  Reader read(checkpoint);
  double number, blocked, bent;
  read(number);
  read(s.target);
  std::vector<Cluster::Memory> of_clusters;
  for (const Cluster& c : s.clusters) {
    Cluster::Memory& m = of_clusters.emplace_back(c.memory());
    read(m.pose), read(m.target), read(m.last_way), read(blocked), read(bent), read(m.caution);
    m.blocked = blocked != 0;
    m.bent = bent != 0;
  }
  Coupling::Memory coupled = s.coupling->memory();
  read(coupled.hand_speed), read(coupled.wrench);
  Measures::Memory seen = s.measures->memory();
  for (int k = 0; k < 2; ++k) read(seen.god[k]), read(seen.target[k]);
  read(s.object);
  for (std::size_t o = 0; s.physics && o < s.object.size(); ++o) {
    if (!s.surroundings.objects[o].loose()) continue;
    Pose<double> pose;
    Vec<double, 6> velocity;
    read(pose), read(velocity);
    s.physics->place(o, pose, velocity);
  }
  read.end();
  if (s.physics) s.physics->forget();
  s.number = static_cast<long>(number);
  for (std::size_t c = 0; c < s.clusters.size(); ++c) {
    s.clusters[c].restore(of_clusters[c]);
    for (std::size_t o = 0; o < s.object.size(); ++o)
      if (s.surroundings.objects[o].loose()) s.clusters[c].place_object(o, s.object[o]);
  }
  s.coupling->restore(coupled);
  s.measures->restore(seen);
}

}  // namespace zwang::god
