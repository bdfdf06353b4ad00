#include <zwang/core/files/problem_file.h>
#include <zwang/experiments/god_hand/run/frame_store.h>

namespace zwang::god {

void write_checkpoint(const std::filesystem::path& directory, const Checkpoint& checkpoint) {
  const auto file = directory / "checkpoint", draft = directory / "checkpoint.new";
  std::ofstream out(draft, std::ios::binary);
  out << checkpoint.frames << '\n' << checkpoint.state;
  out.close();
  if (!out) throw BadFile("cannot write " + file.string());
  std::filesystem::rename(draft, file);
}

Checkpoint read_checkpoint(const std::filesystem::path& directory) {
  std::ifstream in(directory / "checkpoint", std::ios::binary);
  Checkpoint checkpoint;
  if (!in) return checkpoint;
  if (!(in >> checkpoint.frames) || in.get() != '\n' || checkpoint.frames < 0)
    throw BadFile((directory / "checkpoint").string() + ": not a checkpoint");
  checkpoint.state.assign(std::istreambuf_iterator<char>(in), {});
  return checkpoint;
}

}  // namespace zwang::god
