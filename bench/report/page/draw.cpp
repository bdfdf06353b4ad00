#include <zwang/bench/report/page/draw.h>

#include <spawn.h>
#include <sys/wait.h>

#include <stdexcept>

extern char** environ;

namespace zwang::report {

void run_script(const std::string& script, std::vector<std::string> words) {
  words.insert(words.begin(), {"node", ZWANG_REPORT_DIR "/" + script});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  int status = 0;
  if (posix_spawnp(&child, argv[0], nullptr, nullptr, argv.data(), environ) != 0)
    throw std::runtime_error("cannot start " + words[0] + "; ./zwang setup installs it");
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(words[0] + " " + words[1] + " failed");
}

}  // namespace zwang::report
