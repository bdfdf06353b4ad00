#include <mujoco/mujoco.h>
#include <algorithm>
#include <cstring>
#include <sstream>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;

namespace {

struct Line : std::ostringstream {
  Line() { precision(17); }
};
std::ostream& operator<<(std::ostream& out, const Triple& t) { return out << t[0] << " " << t[1] << " " << t[2]; }
std::ostream& operator<<(std::ostream& out, const Turn& q) {
  return out << q[0] << " " << q[1] << " " << q[2] << " " << q[3];
}

struct MuJoCo : World {
  mjModel* model = nullptr;
  mjData* data = nullptr;

  // A body, and inside it those that hang on it by a joint: these have no other freedom.
  void write(std::ostream& out, int i, const Triple& origin) const {
    const Body& b = scene.bodies[i];
    out << "<body pos='" << minus(b.at, origin) << "' quat='" << b.turn << "'>";
    if (b.motion == "driven") out << "<joint type='slide' axis='" << b.velocity << "' armature='1e12'/>";
    if (const Joint* joint = scene.holds(i))
      out << "<joint type='ball' pos='" << minus(joint->at, b.at) << "'/>";
    else if (b.free())
      out << "<freejoint/>";
    out << "<inertial pos='0 0 0' mass='" << b.mass << "' diaginertia='" << b.inertia << "'/>";
    for (const Shape& s : b.shapes)
      out << "<geom type='" << s.kind << "' pos='" << s.at << "' size='"
          << (s.kind == "plane" ? Triple{0, 0, 1}
              : s.kind == "box" ? s.half
                                : Triple{s.radius, 1, 1})
          << "'/>";
    for (const Joint& j : scene.joints)
      if (j.b == i) write(out, j.a, b.at);
    out << "</body>";
  }

  explicit MuJoCo(const Scene& given) : World(given) {
    if (scene.restitution > 0) throw Absent("coefficient of restitution");
    Line out;
    out << "<mujoco><option timestep='" << scene.dt << "' gravity='" << scene.gravity << "' "
        << (scene.tuned ? "cone='elliptic' impratio='100' noslip_iterations='100' iterations='1000' tolerance='0'" : "")
        << "/>";
    out << "<default><geom friction='" << scene.mu << " 0 0' ";
    if (scene.tuned) out << "solref='" << 2 * scene.dt << " 1' solimp='0.99 0.9999 0.001'";
    out << "/></default><worldbody>";
    for (int i = 0; i < scene.size(); ++i)
      if (!scene.holds(i) || scene.holds(i)->b < 0) write(out, i, {});
    out << "</worldbody></mujoco>";
    static mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(out.str().size()));
    std::memcpy(files.filedata[0], out.str().data(), out.str().size());
    char error[500];
    model = mj_loadXML("scene.xml", &files, error, sizeof error), mj_deleteVFS(&files);
    if (!model) throw std::runtime_error(error);
    data = mj_makeData(model);
    mjtNum* v = data->qvel;
    for (int i = 0; i < scene.size(); ++i) {
      const Body& b = scene.bodies[i];
      std::ranges::copy(b.torque, std::ranges::copy(b.force, data->xfrc_applied + 6 * (i + 1)).out);
      if (b.motion == "driven") *v++ = mju_norm3(b.velocity.data());
      if (b.free() && !scene.holds(i)) v = std::ranges::copy(b.velocity, v).out;
      if (b.free()) v = std::ranges::copy(b.spin, v).out;  // the world's, for no body is turned at the start
    }
  }
  ~MuJoCo() override { mj_deleteData(data), mj_deleteModel(model); }

  void step() override { mj_step(model, data); }

  State state(int i) const override {
    mj_fwdPosition(model, data), mj_fwdVelocity(model, data);
    mjtNum v[6], *q = data->xquat + 4 * (i + 1);
    mj_objectVelocity(model, data, mjOBJ_BODY, i + 1, v, 0);
    return {triple(data->xpos + 3 * (i + 1)), {q[0], q[1], q[2], q[3]}, triple(v + 3), triple(v)};
  }
};

}  // namespace

int main() { return serve<MuJoCo>({.engine = "mujoco", .version = mj_versionString(), .licence = "Apache-2.0"}); }
