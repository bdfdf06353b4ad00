#include <zwang/bench/scenes/scene_file.h>

#include <algorithm>
#include <map>
#include <set>

#include <zwang/collision/load.h>
#include <zwang/collision/world.h>
#include <zwang/constraints/ball_joint.h>
#include <zwang/constraints/contact.h>
#include <zwang/constraints/distance.h>
#include <zwang/constraints/prismatic_joint.h>
#include <zwang/constraints/revolute_joint.h>
#include <zwang/constraints/rope.h>
#include <zwang/constraints/universal_joint.h>
#include <zwang/constraints/weld.h>
#include <zwang/core/files/problem_file.h>
#include <zwang/core/model/motion.h>
#include <zwang/core/problem/wording.h>

namespace zwang {
namespace {

constexpr double full_turn = 6.283185307179586;  // rad

Vec3 vector3(const JsonValue& v) {
  const std::vector<double> x = v.numbers(3);
  return {x[0], x[1], x[2]};
}

Vec3 direction(const JsonValue& v) {
  const Vec3 d = vector3(v);
  if (!(d.norm() > 0)) v.fail("a direction, not all zeros");
  return d.normalized();
}

Vec<double, 6> twist(const JsonValue& v) {
  const std::vector<double> x = v.numbers(6);
  return Eigen::Map<const Vec<double, 6>>(x.data());
}

// "rotation": a rotation vector [rad].
Pose<double> pose(const JsonValue& v) {
  Pose<double> out;
  if (v.has("position")) out.position = vector3(v["position"]);
  if (v.has("rotation")) out.rotation = rotation(vector3(v["rotation"]));
  return out;
}

// A body's outside: of what it is made for collisions, and its inertia about its middle [kg m^2].
struct Outside {
  std::optional<collision::Shape> shape = {};
  std::shared_ptr<const collision::Tree> mesh = {};
  Vec3 inertia_of_a_kg = Vec3::Ones();
};

Outside outside(const JsonValue& v, const std::filesystem::path& folder) {
  v.only({"box", "sphere", "capsule", "mesh", "rounding"});
  if (v.size() - (v.has("rounding") ? 1 : 0) != 1) v.fail("one of box, sphere, capsule, mesh");
  Outside out;
  if (v.has("box")) {
    const Vec3 w = vector3(v["box"]);
    if (!(w.minCoeff() > 0)) v["box"].fail("three positive widths");
    const double rounding = v.has("rounding") ? v["rounding"].positive() : 1e-3 * w.minCoeff();
    if (2 * rounding > w.minCoeff()) v["rounding"].fail("at most half of the smallest width");
    out.shape = collision::Shape::rounded_box(w, rounding);
    const Vec3 s = w.cwiseProduct(w) / 12;
    out.inertia_of_a_kg = {s.y() + s.z(), s.z() + s.x(), s.x() + s.y()};
  } else if (v.has("sphere")) {
    const double r = v["sphere"].positive();
    out.shape = collision::Shape::sphere(r);
    out.inertia_of_a_kg.setConstant(0.4 * r * r);
  } else if (v.has("capsule")) {
    const std::vector<double> c = v["capsule"].numbers(2);
    if (!(c[0] > 0 && c[1] > 0)) v["capsule"].fail("[length between the caps' centres, radius], both positive");
    const double l = c[0], r = c[1];
    out.shape = collision::Shape::capsule(l, r);
    // A cylinder and two half balls, by their volumes.
    const double cylinder = l / (l + 4 * r / 3), caps = 1 - cylinder;
    const double along = cylinder * r * r / 2 + caps * 0.4 * r * r;
    const double across = cylinder * (r * r / 4 + l * l / 12) + caps * (0.4 * r * r + l * l / 4 + 0.375 * l * r);
    out.inertia_of_a_kg = {across, along, across};
  } else {
    const collision::MeshName name = collision::parse_mesh_name(v["mesh"].text());
    out.mesh =
        std::make_shared<const collision::Tree>(collision::load_tree(folder / name.file, {.unit = name.unit}).tree);
  }
  return out;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file)
      : file_(file), document_(std::make_shared<const JsonDocument>(file)), root_(*document_) {
    read();
  }
  Instance problem() {
    const std::string mode = root_.has("mode") ? root_["mode"].word({"dynamic", "quasi-static"}) : "dynamic";
    const AssembleOptions options{.dt = root_.has("dt") ? root_["dt"].positive() : 1e-3,
                                  .mode = mode == "dynamic" ? Mode::dynamic : Mode::quasi_static};
    if (root_.has("contacts"))
      for (const JsonValue& v : root_["contacts"].items()) contact(v);
    if (root_.has("detect")) detect(root_["detect"]);
    if (std::ranges::none_of(scene_.bodies, [](const Body& body) { return body.motion == Motion::free; }))
      root_["bodies"].fail("a free body among them");
    Instance out = to_instance({.scene = scene_,
                                .options = options,
                                .target = target_,
                                .k_s = reaching_stiffness(options.dt),
                                .gravity = root_.has("gravity") ? vector3(root_["gravity"]) : gravity,
                                .wrench = force_});
    out.problem.name = root_.has("name") ? root_["name"].text() : file_.stem().string();
    out.family = file_.stem().string();
    if (const std::string reason = bad_input(out.problem); !reason.empty())
      throw BadFile(file_.string() + ": " + reason);
    return out;
  }
  WrittenScene written() {
    WrittenScene out{.document = document_, .root = root_, .scene = scene_, .joints = joints_};
    const std::vector<JsonValue> bodies = root_["bodies"].items();
    for (std::size_t b = 0; b < bodies.size(); ++b)
      out.parts.push_back({names_[b], outside_[b].shape, outside_[b].mesh, bodies[b]});
    return out;
  }

 private:
  void read() {
    root_.only({"format", "name", "mode", "dt", "gravity", "bodies", "joints", "limits", "contacts", "detect"});
    root_["format"].word({"zwang scene 1"});
    for (const JsonValue& v : root_["bodies"].items()) body(v);
    if (root_.has("joints"))
      for (const JsonValue& v : root_["joints"].items()) joint(v);
    if (root_.has("limits"))
      for (const JsonValue& v : root_["limits"].items()) limit(v);
  }
  void body(const JsonValue& v) {
    v.only({"name", "motion", "mass", "inertia", "shape", "position", "rotation", "velocity", "acceleration", "force",
            "target"});
    Body body;
    const std::string name = v["name"].text();
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) v["name"].fail("a name of its own");
    const std::string motion = v.has("motion") ? v["motion"].word({"free", "fixed", "prescribed"}) : "free";
    body.motion = motion == "free" ? Motion::free : motion == "fixed" ? Motion::fixed : Motion::prescribed;
    body.pose = pose(v);
    Outside out = v.has("shape") ? outside(v["shape"], file_.parent_path()) : Outside{};
    if (v.has("mass")) body.mass = v["mass"].positive();
    if (v.has("inertia")) {
      const Vec3 inertia = vector3(v["inertia"]);
      if (!(inertia.minCoeff() > 0)) v["inertia"].fail("three positive moments of inertia (kg m^2)");
      body.inertia = inertia.asDiagonal();
    } else {
      if (out.mesh && motion == "free") v.fail("a member 'inertia', for a mesh says nothing about the mass inside");
      body.inertia = Vec3(body.mass * out.inertia_of_a_kg).asDiagonal();
    }
    if (v.has("velocity")) body.velocity = twist(v["velocity"]);
    if (v.has("acceleration")) {
      if (body.motion != Motion::prescribed) v["acceleration"].fail("\"motion\": \"prescribed\" beside it");
      body.prescribed = twist(v["acceleration"]);
    }
    force_.push_back(v.has("force") ? twist(v["force"]) : Vec<double, 6>::Zero());
    target_.push_back(v.has("target") ? pose(v["target"]) : body.pose);
    names_.push_back(name);
    outside_.push_back(std::move(out));
    scene_.add(body);
  }
  void joint(const JsonValue& v) {
    v.only({"name", "type", "a", "b", "at", "at_b", "axis", "axis_b", "length", "drive"});
    const std::string type = v["type"].word({"ball", "hinge", "universal", "slider", "weld", "distance", "rope"});
    const BodyId a = body_named(v["a"]), b = body_named(v["b"]);
    if (a == b) v["b"].fail("another body than a");
    const std::string text = label(v, a, b);
    const Vec3 point = vector3(v["at"]), point_b = v.has("at_b") ? vector3(v["at_b"]) : point;
    const Vec3 anchor_a = local(a, point), anchor_b = local(b, point_b);
    const Mat3 relative = pose_of(a).rotation.transpose() * pose_of(b).rotation;
    const auto axis = [&] { return direction(v["axis"]); };
    if (type != "distance" && type != "rope") joined_.insert(std::minmax(a, b));
    if (type != "hinge" && v.has("drive")) v["drive"].fail("a hinge beside it");
    joints_.push_back({text, type, {a, b}, count_[type]++, v.has("drive") ? v["drive"].number() : 0, v});
    if (type == "ball") {
      scene_.add(BallJoint{{a, b}, anchor_a, anchor_b}, text);
    } else if (type == "weld") {
      scene_.add(Weld{{a, b}, anchor_a, anchor_b, relative}, text);
    } else if (type == "hinge") {
      scene_.add(RevoluteJoint{{a, b}, anchor_a, anchor_b, local_turn(a, axis()), local_turn(b, axis())}, text);
      if (!hinges_.insert({text, {a, b, axis()}}).second) v["name"].fail("a name of its own");
    } else if (type == "universal") {
      const Vec3 second = direction(v["axis_b"]);
      if (axis().cross(second).norm() < 1e-6) v["axis_b"].fail("a direction across axis");
      scene_.add(UniversalJoint{{a, b}, anchor_a, anchor_b, local_turn(a, axis()), local_turn(b, second)}, text);
    } else if (type == "slider") {
      scene_.add(PrismaticJoint{{a, b}, anchor_a, anchor_b, local_turn(b, axis()), relative}, text);
    } else {
      const double length = v.has("length") ? v["length"].positive() : (point - point_b).norm();
      if (!(length > 0)) v.fail("at and at_b apart, or a length");
      const Distance distance{{a, b}, anchor_a, anchor_b, length};
      if (type == "distance")
        scene_.add(distance, text);
      else
        scene_.add(Rope{distance}, text);
    }
  }
  // Angles count from the pose that the file gives.
  void limit(const JsonValue& v) {
    v.only({"joint", "low", "high"});
    const std::string name = v["joint"].text();
    const auto found = hinges_.find(name);
    if (found == hinges_.end())
      v["joint"].fail("the name of a hinge" +
                      did_you_mean(name, names_of(hinges_, [](const auto& hinge) { return hinge.first; })));
    const Hinge& h = found->second;
    if (!v.has("low") && !v.has("high")) v.fail("a member 'low' or 'high' (rad)");
    HingeRange range;
    if (v.has("low")) range.low = v["low"].number();
    if (v.has("high")) range.high = v["high"].number();
    if (range.low && range.high) {
      if (*range.low > *range.high) v["high"].fail("no less than low");
      if (!(*range.high - *range.low < full_turn)) v["high"].fail("less than a turn above low (rad)");
    }
    for (const JointLimit& limit : hinge_limits(scene_, {h.a, h.b}, h.axis, range))
      scene_.add(limit, name + (limit.side == Side::lower ? ", low" : ", high"));
  }
  void contact(const JsonValue& v) {
    v.only({"name", "a", "b", "point", "normal", "gap", "friction", "surface"});
    const BodyId a = body_named(v["a"]), b = body_named(v["b"]);
    if (a == b) v["b"].fail("another body than a");
    const double friction = v.has("friction") ? v["friction"].number() : 0;
    if (friction < 0) v["friction"].fail("a number that is not negative");
    Contact contact = contact_at(scene_.bodies, a, b, vector3(v["point"]), direction(v["normal"]),
                                 v.has("gap") ? v["gap"].number() : 0, friction);
    if (v.has("surface")) contact.surface = local_turn(b, vector3(v["surface"]));
    scene_.add(contact, label(v, a, b));
  }
  // Contacts of all pairs of shapes that are nearer than `within`, and of shapes with meshes; not of bodies that a
  // joint holds together.
  void detect(const JsonValue& v) {
    v.only({"within", "friction"});
    const double within = v["within"].positive(), friction = v.has("friction") ? v["friction"].number() : 0;
    if (friction < 0) v["friction"].fail("a number that is not negative");
    collision::World world;
    std::vector<BodyId> body_of;
    for (std::size_t b = 0; b < outside_.size(); ++b) {
      const Outside& o = outside_[b];
      const bool scenery = scene_.bodies[b].motion == Motion::fixed;
      if (o.shape) world.add(*o.shape, scene_.bodies[b].pose, {}, scenery);
      if (o.mesh) world.add(o.mesh, scene_.bodies[b].pose);
      if (o.shape || o.mesh) body_of.push_back(static_cast<BodyId>(b));
    }
    std::map<std::pair<BodyId, BodyId>, int> count;
    for (const collision::Touch& t : world.touches(within)) {
      const BodyId a = body_of[at(t.a)], b = body_of[at(t.b)];
      if (joined_.contains(std::minmax(a, b))) continue;
      const int which = count[{a, b}]++;
      scene_.add(contact_at(scene_.bodies, a, b, t.point_a, t.normal, t.gap, friction),
                 names_[at(a)] + " on " + names_[at(b)] + (which ? ", " + std::to_string(which + 1) : ""));
    }
  }
  BodyId body_named(const JsonValue& v) const {
    const std::string name = v.text();
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) v.fail("the name of a body" + did_you_mean(name, names_));
    return static_cast<BodyId>(found - names_.begin());
  }
  std::string label(const JsonValue& v, BodyId a, BodyId b) const {
    if (v.has("name")) return v["name"].text();
    return names_[at(a)] + " on " + names_[at(b)];
  }
  const Pose<double>& pose_of(BodyId b) const { return scene_.bodies[at(b)].pose; }
  Vec3 local(BodyId b, const Vec3& point) const {
    return pose_of(b).rotation.transpose() * (point - pose_of(b).position);
  }
  Vec3 local_turn(BodyId b, const Vec3& d) const { return pose_of(b).rotation.transpose() * d; }

  struct Hinge {
    BodyId a, b;
    Vec3 axis;  // world
  };

  std::filesystem::path file_;
  std::shared_ptr<const JsonDocument> document_;
  JsonValue root_;
  Scene scene_;
  std::vector<std::string> names_;
  std::vector<Outside> outside_;
  std::vector<WrittenScene::Joint> joints_;
  std::set<std::pair<BodyId, BodyId>> joined_;  // by a joint that holds a point: such shapes overlap by design
  std::vector<Vec<double, 6>> force_;
  std::vector<Pose<double>> target_;
  std::map<std::string, Hinge> hinges_;
  std::map<std::string, std::size_t> count_;  // of joints, by type
};

}  // namespace

Instance read_scene_file(const std::filesystem::path& file) { return Reader(file).problem(); }

WrittenScene read_written_scene(const std::filesystem::path& file) { return Reader(file).written(); }

// A direction that is beyond the bound by more than half of what the range leaves free is nearer to the other bound.
std::vector<JointLimit> hinge_limits(const Scene& scene, std::array<BodyId, 2> bodies, const Vec3& axis,
                                     const HingeRange& range) {
  const auto turned = [&](BodyId b, const Vec3& d) -> Vec3 {
    return scene.bodies[at(b)].pose.rotation.transpose() * d;
  };
  const Vec3 across = axis.unitOrthogonal();
  JointLimit limit{.bodies = bodies,
                   .axis = turned(bodies[0], axis),
                   .zero = turned(bodies[0], across),
                   .direction = turned(bodies[1], across),
                   .reach = 10};  // rad: the row is always there
  if (range.low && range.high) limit.farthest = (full_turn - (*range.high - *range.low)) / 2;
  std::vector<JointLimit> limits;
  if (!(limit.farthest > 0)) return limits;
  for (const auto& [bound, side] : {std::pair(range.low, Side::lower), {range.high, Side::upper}})
    if (bound) {
      limit.bound = *bound;
      limit.side = side;
      limits.push_back(limit);
    }
  return limits;
}

}  // namespace zwang
