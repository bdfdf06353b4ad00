#include <mujoco/mujoco.h>
#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <zwang/bench/engines/adapters/protocol.h>

using namespace zwang::engines;

namespace {

struct MuJoCo : World {
  mjModel* model = nullptr;
  mjData* data = nullptr;

  explicit MuJoCo(const Scene& given) : World(given) {
    static mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "scene.xml", static_cast<int>(scene.mjcf.size()));
    std::memcpy(files.filedata[0], scene.mjcf.data(), scene.mjcf.size());
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
      if (b.free()) v = std::ranges::copy(b.spin, v).out;  // the world's, for no free body is turned at the start
    }
  }
  ~MuJoCo() override { mj_deleteData(data), mj_deleteModel(model); }

  void advance() override { mj_step(model, data); }

  State state(int i) const override {
    mj_fwdPosition(model, data), mj_fwdVelocity(model, data);
    mjtNum v[6];
    mj_objectVelocity(model, data, mjOBJ_BODY, i + 1, v, 0);
    return state_of(data->xpos + 3 * (i + 1), data->xquat + 4 * (i + 1), v + 3, v);
  }
};

}  // namespace

int main() {
  return serve<MuJoCo>({.engine = "mujoco",
                        .version = mj_versionString(),
                        .licence = "Apache-2.0",
                        .lacks = {"coefficient of restitution"},
                        .mjcf = true});
}
