#include <zwang/bench/capture/model_file.h>

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>

#include <zwang/core/files/problem_file.h>

namespace zwang {

void DeleteModel::operator()(mjModel_* model) const { mj_deleteModel(model); }
void DeleteModel::operator()(mjData_* data) const { mj_deleteData(data); }

std::unique_ptr<mjModel_, DeleteModel> load_model(const std::filesystem::path& file) {
  mju_user_error = [](const char* message) { throw std::runtime_error(message); };
  mju_user_warning = [](const char*) {};
  if (!std::filesystem::exists(file)) throw BadFile(file.string() + ": no such file");
  std::array<char, 1000> error{};
  std::unique_ptr<mjModel_, DeleteModel> model(mj_loadXML(file.c_str(), nullptr, error.data(), error.size()));
  if (!model) {
    std::string text(error.data());
    std::replace(text.begin(), text.end(), '\n', ' ');
    throw BadFile(file.string() + ": MuJoCo says: " + text);
  }
  return model;
}

}  // namespace zwang
