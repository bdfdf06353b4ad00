#include <zwang/bench/report/page/draw.h>

#include <sys/wait.h>

#include <cstdlib>
#include <stdexcept>

#include <zwang/core/files/embedded.h>
#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

ZWANG_EMBEDDED(figures_mjs, ZWANG_FIGURES)
ZWANG_EMBEDDED(draw_mjs, ZWANG_DRAW)

namespace zwang::report {

using std::filesystem::path;

static void run(const char* name, std::string_view script, const path& directory, const std::vector<path>& words) {
  const path file = directory / name;  // Node takes modules from files only
  replace_file(file, script);
  std::string command = "command -v node > /dev/null || exit 127; exec node " + quoted(file.string());
  for (const path& word : words) command += " " + quoted(word.string());
  const int status = std::system(command.c_str());
  std::filesystem::remove(file);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw std::runtime_error("cannot start node, which draws figures for print; ./zwang setup installs it");
  if (status != 0) throw std::runtime_error(std::string("node failed in ") + name);
}

void draw_figures(const path& data, const path& figures, const path& tables) {
  run("figures.mjs", figures_mjs(), figures, {data, figures, tables});
}

void draw(const path& findings, const path& directory) {
  run("draw.mjs", draw_mjs(), directory, {findings, directory});
}

}  // namespace zwang::report
