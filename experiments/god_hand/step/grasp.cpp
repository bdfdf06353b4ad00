#include <zwang/experiments/god_hand/step/grasp.h>

#include <algorithm>

#include <zwang/core/problem/law.h>

namespace zwang::god {

Grasp::Grasp(const Scene& scene, const Surroundings& surroundings, const Options& options)
    : surroundings_(&surroundings),
      options_(options),
      share_(options.force_stiffness * options.dt * (options.dt + coupling_time)),
      scene_(scene),
      solver_(options) {}

// Those that a contact is about. Their inertia is measured in that of the god objects, whose rows then stay as they
// are.
void Grasp::free_objects(const Cluster& cluster, const Physics& physics, std::span<const Vec<double, 6>> others) {
  for (std::size_t b = cluster.size(); b < scene_.bodies.size(); ++b) scene_.bodies[b].motion = zwang::Motion::fixed;
  for (const Contacts::Row& row : cluster.rows()) {
    const int o = cluster.object_of(row.touch.b);
    if (o >= 0 && surroundings_->objects[static_cast<std::size_t>(o)].loose())
      scene_.bodies[cluster.size() + static_cast<std::size_t>(o)].motion = zwang::Motion::free;
  }
  for (std::size_t o = 0; o < surroundings_->objects.size(); ++o) {
    Body& body = scene_.bodies[cluster.size() + o];
    if (body.motion != zwang::Motion::free) continue;
    const Object& object = surroundings_->objects[o];
    body.mass = object.mass / share_;
    body.inertia = object.inertia / share_;
    const Mat3& R = body.pose.rotation;
    Vec<double, 6> z = physics.velocity(o) / options_.dt;
    z.head<3>() += surroundings_->gravity + others[o].head<3>() / object.mass;
    z.tail<3>() += R * object.inertia.inverse() * R.transpose() * others[o].tail<3>();
    wanted_.push_back(z);
  }
}

bool Grasp::solve(const Cluster& cluster, std::span<const Vec<double, 6>> target_velocity, const Physics& physics,
                  std::span<const Vec<double, 6>> others, double seconds) {
  const double dt = options_.dt, damper = coupling_time / dt;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) scene_.bodies[b].pose = cluster.objects().scene.bodies[b].pose;
  auto& contacts = scene_.list_of<Contact>();
  contacts = cluster.contacts();
  for (Contact& c : contacts.all) c.surface.setZero();
  gods_ = 6 * static_cast<Index>(cluster.size());

  wanted_.clear();
  let_go();
  for (std::size_t b = 0; b < cluster.size(); ++b)
    wanted_.push_back((twist_between(cluster.poses()[b], cluster.targets()[b]) + damper * dt * target_velocity[b]) /
                      ((1 + damper) * dt * dt));
  free_objects(cluster, physics, others);
  z_u_.resize(6 * static_cast<Index>(wanted_.size()));
  for (std::size_t k = 0; k < wanted_.size(); ++k) z_u_.segment<6>(6 * static_cast<Index>(k)) = wanted_[k];

  assembler_.assemble(scene_, z_u_, {.dt = dt}, problem_);
  if (options_.law == Options::Friction::convex) problem_.law = without_lift(problem_.law);
  solver_.begin();
  if (!solver_.solve(problem_, seconds, solution_)) return false;
  first_rows(problem_, cluster.rows().size(), row_at_);
  for (std::size_t b = 0; b < cluster.size(); ++b)
    motion_.push_back(solution_.z.segment<6>(6 * static_cast<Index>(b)) * dt * dt);
  for (std::size_t r = 0; r < row_at_.size(); ++r) {
    const int o = cluster.object_of(cluster.rows()[r].touch.b);
    if (o < 0 || !surroundings_->objects[static_cast<std::size_t>(o)].loose() || solution_.lambda[row_at_[r]] <= 0)
      continue;
    const auto object = static_cast<std::size_t>(o);
    if (std::find(held_.begin(), held_.end(), object) == held_.end()) held_.push_back(object);
  }
  return true;
}

Grasp::Hold Grasp::hold() const {
  const std::size_t objects = surroundings_->objects.size();
  Hold hold{motion_, std::vector<double>(objects, 0)};
  hold.motion.resize(scene_.bodies.size() - objects, Vec<double, 6>::Zero());
  for (const std::size_t o : held_) hold.objects[o] = 1;
  return hold;
}

void Grasp::take(const Hold& hold) {
  let_go();
  motion_ = hold.motion;
  for (std::size_t o = 0; o < hold.objects.size(); ++o)
    if (hold.objects[o] != 0) held_.push_back(o);
}

void Grasp::read(std::size_t row, Vec<double, 6>& on_object, Vec<double, 6>& on_god) const {
  on_object.setZero();
  on_god.setZero();
  const Index first = row_at_[row];
  for (Index i = first; i <= first + problem_.tangents(first); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(problem_.J, i); entry; ++entry)
      (entry.col() < gods_ ? on_god : on_object)[entry.col() % 6] += share_ * solution_.lambda[i] * entry.value();
}

}  // namespace zwang::god
