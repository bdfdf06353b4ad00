#include <zwang/bench/report/page/draw.h>

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>
#include <string_view>

#include <zwang/core/files/embedded.h>

extern char** environ;

ZWANG_EMBEDDED(figures_mjs, ZWANG_FIGURES)
ZWANG_EMBEDDED(draw_mjs, ZWANG_DRAW)

namespace zwang::report {
namespace {

// Node takes modules from files only.
class ScriptFile {
 public:
  explicit ScriptFile(std::string_view text) {
    std::string name = (std::filesystem::temp_directory_path() / "zwang-XXXXXX.mjs").string();
    const int file = mkstemps(name.data(), 4);
    const bool written = file >= 0 && write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    if (file >= 0) close(file);
    path_ = name;
    if (!written) throw std::runtime_error(name + ": cannot be written");
  }
  ~ScriptFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  ScriptFile(const ScriptFile&) = delete;
  ScriptFile& operator=(const ScriptFile&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

void run(const char* name, std::string_view script, std::vector<std::string> words) {
  const ScriptFile file(script);
  words.insert(words.begin(), {"node", file.path().string()});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  int status = 0;
  if (posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ) != 0)
    throw std::runtime_error("cannot start node, which draws figures for print; ./zwang setup installs it");
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(std::string("node failed in ") + name);
}

}  // namespace

void draw_figures(const std::filesystem::path& data, const std::filesystem::path& figures,
                  const std::filesystem::path& tables) {
  run("figures.mjs", figures_mjs(), {data.string(), figures.string(), tables.string()});
}

void draw(const std::filesystem::path& findings, const std::filesystem::path& directory) {
  run("draw.mjs", draw_mjs(), {findings.string(), directory.string()});
}

}  // namespace zwang::report
