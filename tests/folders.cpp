#include "tests/folders.h"

namespace zwang {

std::filesystem::path source_dir() { return ZWANG_SOURCE_DIR; }

}  // namespace zwang
