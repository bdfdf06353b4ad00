#include <stdexcept>

#include <zwang/experiments/god_hand/tools/mechanism.h>

namespace zwang::god {

Tool of_model(const std::filesystem::path& file) {
  throw std::invalid_argument(file.string() +
                              ": MJCF and URDF models need MuJoCo, which this program was built without");
}

}  // namespace zwang::god
