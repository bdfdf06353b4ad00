#include <mujoco/mujoco.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include <zwang/bench/capture/model_file.h>
#include <zwang/bench/scenes/scene_file.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/experiments/god_hand/tools/hull.h>
#include <zwang/experiments/god_hand/tools/mechanism.h>

namespace zwang::god {
namespace {

using collision::Shape;

constexpr double closed = 1.5;     // rad of the closing angle: hinges are at the end of their range
constexpr double pivot = 1e-3;     // m, radius of a body that the model gives no geom
constexpr double lightest = 1e-4;  // kg, of a body

Vec3 vec3(const mjtNum* x) { return {x[0], x[1], x[2]}; }
Mat3 mat3(const mjtNum* x) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(x); }

// A geom as a convex shape.
struct ConvexGeom {
  Shape shape;
  Pose<double> pose;  // in the model, at rest
  Vec3 widths;        // m, of the box about it
  double volume;      // m^3
};

class FromModel {
 public:
  explicit FromModel(const std::filesystem::path& file) : file_(file), model_(load_model(file)) {
    data_.reset(mj_makeData(model_.get()));
    if (!data_) throw BadFile(file.string() + ": MuJoCo has not enough memory for this model");
    mj_kinematics(model_.get(), data_.get());
    mj_comPos(model_.get(), data_.get());
    main_.assign(at(model_->nbody), -1);
  }

  Tool tool() {
    const mjModel& m = *model_;
    for (int e = 0; e < m.neq; ++e)
      if (m.eq_active[e] && (m.eq_type[e] == mjEQ_CONNECT || m.eq_type[e] == mjEQ_WELD))
        throw BadFile(file_.string() + ": equality " + name(mjOBJ_EQUALITY, e) +
                      ": expected none that closes a loop or holds a body");
    root_ = root();
    frame_ = {vec3(data_->xpos + 3 * root_), mat3(data_->xmat + 9 * root_)};
    for (int b = root_; b < m.nbody; ++b)
      if (b == root_ || main_[at(m.body_parentid[b])] >= 0) add_body(b);
    complete(tool_, hinges_);
    for (std::size_t a = 0; a < body_.size(); ++a)
      for (std::size_t b = a + 1; b < body_.size(); ++b)
        if (!meet(a, b)) tool_.objects.pass(static_cast<BodyId>(a), static_cast<BodyId>(b));
    return std::move(tool_);
  }

 private:
  [[noreturn]] void refuse(int kind, int id, const std::string& expected) const {
    const char* what = kind == mjOBJ_BODY    ? "body "
                       : kind == mjOBJ_JOINT ? "joint "
                       : kind == mjOBJ_GEOM  ? "geom "
                                             : "";
    throw BadFile(file_.string() + ": " + what + name(kind, id) + ": expected " + expected);
  }

  // `mark`: about a name that is given.
  std::string name(int kind, int id, const std::string& mark = "'") const {
    const char* given = mj_id2name(model_.get(), kind, id);
    return given ? mark + given + mark : "number " + std::to_string(id);
  }

  bool is_urdf() const {
    const std::string text = read_stored(file_).bytes;
    return text.find("<robot") < text.find("<mujoco");
  }

  // The first body on the world that moves, or carries what does. Others stand for surroundings; none of them may move.
  // Of a URDF model, MuJoCo makes the base link part of the world.
  int root() const {
    if (is_urdf()) return 0;
    int found = 0;
    for (int b = 1; b < model_->nbody; ++b) {
      if (model_->body_parentid[b] != 0 || !moves(b)) continue;
      if (found != 0)
        refuse(mjOBJ_BODY, b, "one tree of bodies that move, and it is not joined to " + name(mjOBJ_BODY, found));
      found = b;
    }
    if (found == 0 && model_->nbody > 1) found = 1;
    if (found == 0) throw BadFile(file_.string() + ": expected a body in the model");
    return found;
  }

  // Of all that hang on the body, or the body itself.
  bool moves(int body) const {
    for (int b = body; b < model_->nbody; ++b) {
      int up = b;
      while (up > body) up = model_->body_parentid[up];
      if (up == body && model_->body_jntnum[b] > 0) return true;
    }
    return false;
  }

  // A body's parts are welded to its first one, that one to the body it hangs on, unless joints do. Between two joints
  // of a body there is a pivot: a small ball that meets no part of the tool.
  void add_body(int body) {
    const mjModel& m = *model_;
    BodyId& main = main_[at(body)];
    const int joints = body == root_ ? 0 : m.body_jntnum[body];
    const BodyId parent = body == root_ ? -1 : main_[at(m.body_parentid[body])];
    BodyId on = parent;
    std::vector<ConvexGeom> geoms;
    const std::vector<int> used = geoms_of(body);
    double volume = 0;
    for (const int g : used) geoms.push_back(convex(g)), volume += geoms.back().volume;
    // What the world carries rigidly may have no mass in a model: then that of water.
    const double mass = std::max(m.body_mass[body] > 0 ? m.body_mass[body] : 1000 * volume, lightest);
    const Mat3 axes = mat3(data_->ximat + 9 * body);
    Mat3 inertia = axes * vec3(m.body_inertia + 3 * body).asDiagonal() * axes.transpose();
    if (!(m.body_inertia[3 * body] > 0)) inertia = 1e-4 * mass * Mat3::Identity();  // kg m^2: a ball of 16 mm
    if (geoms.empty() && joints == 0 && body != root_) {
      main = parent;
      return;
    }
    for (int j = 0; j + 1 < joints; ++j) {
      const int joint = m.body_jntadr[body] + j;
      const BodyId between = add_pivot(body, vec3(data_->xanchor + 3 * joint), 0.01 * mass, 0.01 * inertia.trace() / 3);
      add_joint(joint, on, between);
      on = between;
    }
    if (geoms.empty()) {
      main = add_pivot(body, vec3(data_->xpos + 3 * body), mass, inertia.trace() / 3);
    } else {
      for (std::size_t k = 0; k < geoms.size(); ++k) {
        const ConvexGeom& geom = geoms[k];
        const double share = mass * geom.volume / volume;
        Mat3 own;
        if (geoms.size() == 1 && m.body_mass[body] > 0) {
          const Vec3 off = vec3(data_->xipos + 3 * body) - geom.pose.position;
          own = inertia + mass * (off.squaredNorm() * Mat3::Identity() - off * off.transpose());
        } else {
          own = geom.pose.rotation * box_body(geom.widths, share, {}).inertia * geom.pose.rotation.transpose();
        }
        const BodyId part = add_part(body, geom.shape, geom.pose, share, own);
        geom_.back() = used[k];
        if (k == 0) main = part;
        if (k == 0 && (joints > 0 || parent < 0)) continue;
        const BodyId rigid = k == 0 ? parent : main;
        const Pose<double>&a = tool_.objects.scene.bodies[at(rigid)].pose,
              &b = tool_.objects.scene.bodies[at(part)].pose;
        tool_.objects.scene.add(Weld{{rigid, part},
                                     a.rotation.transpose() * (b.position - a.position),
                                     Vec3::Zero(),
                                     a.rotation.transpose() * b.rotation});
      }
    }
    if (joints > 0) add_joint(m.body_jntadr[body] + joints - 1, on, main);
  }

  // Limits and drive count from where the hinge is at rest, the model's angle from its ref.
  void add_joint(int joint, BodyId on, BodyId part) {
    const mjModel& m = *model_;
    Scene& scene = tool_.objects.scene;
    const Vec3 anchor = vec3(data_->xanchor + 3 * joint) - frame_.position, axis = vec3(data_->xaxis + 3 * joint);
    const Pose<double>&a = scene.bodies[at(on)].pose, &b = scene.bodies[at(part)].pose;
    const Vec3 anchor_a = a.rotation.transpose() * (anchor - a.position),
               anchor_b = b.rotation.transpose() * (anchor - b.position);
    if (m.jnt_type[joint] == mjJNT_BALL) {
      scene.add(BallJoint{{on, part}, anchor_a, anchor_b});
      return;
    }
    if (m.jnt_type[joint] != mjJNT_HINGE)
      refuse(mjOBJ_JOINT, joint,
             "a hinge or a ball; a body slides or is free at the root alone, which follows the motion");
    scene.add(
        RevoluteJoint{{on, part}, anchor_a, anchor_b, a.rotation.transpose() * axis, b.rotation.transpose() * axis});
    const double rest = m.qpos0[m.jnt_qposadr[joint]], low = m.jnt_range[2 * joint], high = m.jnt_range[2 * joint + 1];
    HingeDrive hinge{.name = name(mjOBJ_JOINT, joint, ""), .body = part, .scale = 0, .rest = rest};
    if (m.jnt_limited[joint]) {
      for (const JointLimit& limit : hinge_limits(scene, {on, part}, axis, {low - rest, high - rest})) scene.add(limit);
      if (std::abs(low) != std::abs(high))
        hinge.scale = ((std::abs(low) > std::abs(high) ? low : high) - rest) / closed;
    }
    hinges_.push_back(hinge);
  }

  // `pose` and `inertia` in the model's axes.
  BodyId add_part(int body, const Shape& shape, const Pose<double>& pose, double mass, const Mat3& inertia) {
    if (std::ssize(tool_.objects.shapes) == GodObjects::most)
      throw BadFile(file_.string() + ": body " + name(mjOBJ_BODY, body) + ": expected at most " +
                    std::to_string(GodObjects::most) + " parts up to here: geoms, and joints beyond a body's first");
    const Mat3 R = pose.rotation;
    body_.push_back(body);
    geom_.push_back(-1);
    return tool_.objects.add(
        Body{.pose = {pose.position - frame_.position, R}, .mass = mass, .inertia = R.transpose() * inertia * R},
        shape);
  }

  BodyId add_pivot(int body, const Vec3& at, double mass, double inertia) {
    const BodyId id = add_part(body, Shape::sphere(pivot), {at, Mat3::Identity()}, mass, inertia * Mat3::Identity());
    for (BodyId other = 0; other < id; ++other) tool_.objects.pass(other, id);
    return id;
  }

  // Those that take part in collisions; where none does, all.
  std::vector<int> geoms_of(int body) const {
    std::vector<int> all, meeting;
    for (int g = model_->body_geomadr[body]; g < model_->body_geomadr[body] + model_->body_geomnum[body]; ++g) {
      all.push_back(g);
      if (model_->geom_contype[g] != 0 || model_->geom_conaffinity[g] != 0) meeting.push_back(g);
    }
    return meeting.empty() ? all : meeting;
  }

  // Hulls of round bodies are rounded, so that they are no larger than what they stand for.
  ConvexGeom convex(int geom) const {
    const mjModel& m = *model_;
    const Vec3 size = vec3(m.geom_size + 3 * geom);
    Pose<double> pose{vec3(data_->geom_xpos + 3 * geom), mat3(data_->geom_xmat + 9 * geom)};
    const double pi = std::numbers::pi;
    switch (m.geom_type[geom]) {
      case mjGEOM_SPHERE:
        return {Shape::sphere(size.x()), pose, Vec3::Constant(2 * size.x()),
                4 * pi / 3 * size.x() * size.x() * size.x()};
      case mjGEOM_CAPSULE: {
        const Mat3 y_to_z{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
        pose.rotation = pose.rotation * y_to_z;
        const double r = size.x(), l = 2 * size.y();
        return {Shape::capsule(l, r), pose, {2 * r, l + 2 * r, 2 * r}, pi * r * r * (l + 4 * r / 3)};
      }
      case mjGEOM_BOX: {
        const Vec3 widths = 2 * size;
        return {Shape::rounded_box(widths, std::min(1e-3, 0.2 * widths.minCoeff())), pose, widths, widths.prod()};
      }
      case mjGEOM_CYLINDER: {
        const double r = size.x(), half = size.y(), rounding = std::min(5e-4, 0.2 * std::min(r, half));
        std::vector<Vec3> rim;
        for (int k = 0; k < 64; ++k) {
          const double turn = 2 * pi * (k / 2) / 32, side = k % 2 == 0 ? -1 : 1;
          rim.emplace_back((r - rounding) * std::cos(turn), (r - rounding) * std::sin(turn), side * (half - rounding));
        }
        return {Shape::hull(rim, rounding), pose, {2 * r, 2 * r, 2 * half}, 2 * pi * r * r * half};
      }
      case mjGEOM_ELLIPSOID: {
        const double rounding = std::min(5e-4, 0.2 * size.minCoeff());
        std::vector<Vec3> points = directions();
        for (Vec3& p : points) p = p.cwiseProduct(size - Vec3::Constant(rounding));
        return {Shape::hull(points, rounding), pose, 2 * size, 4 * pi / 3 * size.prod()};
      }
      case mjGEOM_MESH: {
        const int mesh = m.geom_dataid[geom];
        const float* from = m.mesh_vert + 3 * m.mesh_vertadr[mesh];
        std::vector<Vec3> vertices;
        for (int v = 0; v < m.mesh_vertnum[mesh]; ++v)
          vertices.emplace_back(from[3 * v], from[3 * v + 1], from[3 * v + 2]);
        const Hull hull = hull_of(vertices);
        pose.position = pose * hull.middle;
        return {hull.shape, pose, hull.widths, hull.widths.prod()};
      }
      default:
        refuse(mjOBJ_GEOM, geom, "a sphere, capsule, box, cylinder, ellipsoid or mesh on a body that moves");
    }
  }

  // As the model has it: by its bits, and but for what it excludes and for what a joint connects.
  bool meet(std::size_t a, std::size_t b) const {
    const mjModel& m = *model_;
    const int ga = geom_[a], gb = geom_[b];
    if (ga < 0 || gb < 0) return false;
    if ((m.geom_contype[ga] & m.geom_conaffinity[gb]) == 0 && (m.geom_contype[gb] & m.geom_conaffinity[ga]) == 0)
      return false;
    for (int e = 0; e < m.nexclude; ++e) {
      const int one = (m.exclude_signature[e] >> 16) - 1, two = (m.exclude_signature[e] & 0xffff) - 1;
      if ((one == body_[a] && two == body_[b]) || (one == body_[b] && two == body_[a])) return false;
    }
    const int wa = m.body_weldid[body_[a]], wb = m.body_weldid[body_[b]];
    return wa != wb && m.body_weldid[m.body_parentid[wa]] != wb && m.body_weldid[m.body_parentid[wb]] != wa;
  }

  std::filesystem::path file_;
  std::unique_ptr<mjModel, DeleteModel> model_;
  std::unique_ptr<mjData, DeleteModel> data_;
  int root_ = 0;
  Pose<double> frame_;            // of the root body in the model
  std::vector<BodyId> main_;      // by body of the model: the part that joints hold; -1: none yet
  std::vector<int> body_, geom_;  // by part; geom -1: a pivot
  std::vector<HingeDrive> hinges_;
  Tool tool_;
};

}  // namespace

Tool of_model(const std::filesystem::path& file) { return FromModel(file).tool(); }

}  // namespace zwang::god
