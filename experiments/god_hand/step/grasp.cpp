#include <zwang/experiments/god_hand/step/grasp.h>

#include <algorithm>

#include <zwang/core/problem/deadline.h>
#include <zwang/core/problem/law.h>

namespace zwang::god {
namespace {

constexpr double sticks = 100;  // a mu at which everything does

}  // namespace

Grasp::Grasp(const Scene& scene, const Surroundings& surroundings, const Options& options)
    : surroundings_(&surroundings),
      options_(options),
      share_(options.force_stiffness * options.dt * (options.dt + coupling_time)),
      scene_(scene),
      grip_(options),
      outside_(options),
      lead_(scene.bodies.size() - surroundings.objects.size(), Vec<double, 6>::Zero()) {}

void Grasp::let_go() {
  held_.clear();
  motion_.clear();
  std::ranges::fill(lead_, Vec<double, 6>::Zero());
}

void Grasp::write_contacts(const Cluster& cluster) {
  auto& hard = scene_.list_of<Contact>();
  hard = cluster.contacts();
  for (Contact& c : hard.all) c.surface.setZero();
  if (options_.pads == 0) return;
  auto& pads = scene_.list_of<PadContact>();
  pads.labels.swap(hard.labels);
  pads.keys.swap(hard.keys);
  pads.all.clear();
  const auto lead = [&](BodyId body, const Vec3& arm) -> Vec3 {
    if (body >= static_cast<BodyId>(lead_.size())) return Vec3::Zero();
    const Vec<double, 6>& of_bone = lead_[at(body)];
    return of_bone.head<3>() + of_bone.tail<3>().cross(arm);
  };
  // What a bone leads by is no slip.
  for (Contact& c : hard.all) {
    const Body &a = scene_.bodies[at(c.bodies[0])], &b = scene_.bodies[at(c.bodies[1])];
    const Vec3 point = a.pose * c.point_a;
    c.surface = b.pose.rotation.transpose() *
                (lead(c.bodies[0], point - a.pose.position) - lead(c.bodies[1], point - b.pose.position)) / options_.dt;
    pads.all.push_back({c, share_ / (options_.pads * options_.dt * options_.dt)});
  }
  hard.all.clear();
}

// Those that a contact is about. Their inertia is measured in that of the god objects, whose rows then stay as they
// are.
void Grasp::free_objects(const Cluster& cluster, const Physics& physics, std::span<const Vec<double, 6>> others) {
  for (std::size_t b = cluster.size(); b < scene_.bodies.size(); ++b) scene_.bodies[b].motion = zwang::Motion::fixed;
  for (const Contacts::Row& row : cluster.rows()) {
    const int o = cluster.object_of(row.touch.b);
    if (o >= 0 && surroundings_->objects[at(o)].loose())
      scene_.bodies[cluster.size() + at(o)].motion = zwang::Motion::free;
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
  const Deadline deadline(seconds);
  const double dt = options_.dt, damper = coupling_time / dt;
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) scene_.bodies[b].pose = cluster.objects().scene.bodies[b].pose;
  write_contacts(cluster);
  gods_ = 6 * static_cast<Index>(cluster.size());

  wanted_.clear();
  for (std::size_t b = 0; b < cluster.size(); ++b)
    wanted_.push_back((twist_between(cluster.poses()[b], cluster.targets()[b]) + damper * dt * target_velocity[b] +
                       damper * lead_[b]) /
                      ((1 + damper) * dt * dt));
  let_go();
  free_objects(cluster, physics, others);
  z_u_ = Eigen::Map<const Vector>(wanted_.data()->data(), 6 * std::ssize(wanted_));

  auto& [assembler, solver, problem, solution] = grip_;
  assembler.assemble(scene_, z_u_, {.dt = dt}, problem);
  if (options_.law == Options::Friction::convex) problem.law = without_lift(problem.law);
  solver.begin();
  outside_.solver.begin();
  if (!solver.solve(problem, seconds, solution)) return false;
  first_rows(problem, cluster.rows().size(), row_at_);
  for (std::size_t b = 0; b < cluster.size(); ++b)
    motion_.push_back(solution.z.segment<6>(6 * static_cast<Index>(b)) * dt * dt);
  for (std::size_t r = 0; r < row_at_.size(); ++r) {
    const int o = cluster.object_of(cluster.rows()[r].touch.b);
    if (o < 0 || !surroundings_->objects[at(o)].loose() || solution.lambda[row_at_[r]] <= 0) continue;
    const auto object = at(o);
    if (std::find(held_.begin(), held_.end(), object) == held_.end()) held_.push_back(object);
  }
  if (options_.pads > 0) stay_outside(cluster, deadline.left());
  return true;
}

// Across its normals the outside of a pad goes where its bone goes. Without that, or with the mu of the grip, which the
// weak forces here would exhaust, the outsides slide off what the bones hold. Coulomb's law often has no answer within
// the limit here, and the frame is limited; the convex one always had, but lifts the pads where they do slide.
void Grasp::stay_outside(const Cluster& cluster, double seconds) {
  Index column = gods_;
  for (std::size_t b = cluster.size(); b < scene_.bodies.size(); ++b) {
    Body& body = scene_.bodies[b];
    if (body.motion != zwang::Motion::free) continue;
    body.motion = zwang::Motion::prescribed;
    body.prescribed = grip_.solution.z.segment<6>(column);
    column += 6;
  }
  auto& pads = scene_.list_of<PadContact>();
  pads.all.clear(), pads.labels.clear(), pads.keys.clear();
  auto& contacts = scene_.list_of<Contact>();
  contacts = cluster.contacts();
  const auto slip = [&](Index row) { return grip_.problem.J.row(row).dot(grip_.solution.z) - grip_.problem.c[row]; };
  for (std::size_t r = 0; r < contacts.all.size(); ++r) {
    Contact& c = contacts.all[r];
    const Index row = row_at_[r];
    const bool presses = grip_.solution.lambda[row] > 0 && grip_.problem.tangents(row) == 2;
    c.friction = presses ? sticks : 0;
    c.surface.setZero();
    if (presses) c.surface = options_.dt * (slip(row + 1) * c.frame.col(1) + slip(row + 2) * c.frame.col(2));
  }
  z_u_ = grip_.solution.z.head(gods_);
  auto& [assembler, solver, problem, solution] = outside_;
  assembler.assemble(scene_, z_u_, {.dt = options_.dt}, problem);
  if (!solver.solve(problem, seconds, solution)) return;
  for (std::size_t b = 0; b < cluster.size(); ++b) {
    const Vec<double, 6> bones = motion_[b];
    motion_[b] = solution.z.segment<6>(6 * static_cast<Index>(b)) * options_.dt * options_.dt;
    lead_[b] = bones - motion_[b];
  }
}

Grasp::Hold Grasp::hold() const {
  const std::size_t objects = surroundings_->objects.size();
  Hold hold{motion_, std::vector<double>(objects, 0), lead_};
  hold.motion.resize(scene_.bodies.size() - objects, Vec<double, 6>::Zero());
  for (const std::size_t o : held_) hold.objects[o] = 1;
  return hold;
}

void Grasp::take(const Hold& hold) {
  let_go();
  motion_ = hold.motion;
  lead_ = hold.lead;
  for (std::size_t o = 0; o < hold.objects.size(); ++o)
    if (hold.objects[o] != 0) held_.push_back(o);
}

void Grasp::read(std::size_t row, Vec<double, 6>& on_object, Vec<double, 6>& on_god) const {
  on_object.setZero();
  on_god.setZero();
  const Index first = row_at_[row];
  const Problem& p = grip_.problem;
  const auto bodies = static_cast<Index>(6 * wanted_.size());
  for (Index i = first; i <= first + p.tangents(first); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(p.J, i); entry; ++entry)
      if (entry.col() < bodies)
        (entry.col() < gods_ ? on_god : on_object)[entry.col() % 6] +=
            share_ * grip_.solution.lambda[i] * entry.value();
}

}  // namespace zwang::god
