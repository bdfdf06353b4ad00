#pragma once

#include <filesystem>
#include <memory>

struct mjModel_;
struct mjData_;

namespace zwang {

struct DeleteModel {
  void operator()(mjModel_* model) const;
  void operator()(mjData_* data) const;
};

// An MJCF or URDF model as MuJoCo reads it. From then on MuJoCo's own complaints are exceptions. Throws BadFile with
// MuJoCo's message.
std::unique_ptr<mjModel_, DeleteModel> load_model(const std::filesystem::path& file);

}  // namespace zwang
