#include <zwang/bench/program/options.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <stdexcept>

#include <zwang/bench/suite/plan.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

// Lines of at most 100 characters: CLI11 2.1 breaks none. What follows hangs under where the line's last column begins.
static std::string wrapped(const std::string& text) {
  constexpr std::size_t width = 100;
  std::string all;
  for (std::string line : split(text, '\n')) {
    const std::size_t word = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t column = line.find_first_not_of(' ', line.find("  ", word));
    const std::string hang(column < width / 2 ? column : word, ' ');
    for (std::size_t end; line.size() > width && (end = line.rfind(' ', width)) > hang.size() && end != line.npos;) {
      all += line.substr(0, end) + '\n';
      line = hang + line.substr(end + 1);
    }
    all += line + '\n';
  }
  return all;
}

void introduce(CLI::App& app, const std::string& name, const std::string& examples) {
  app.name("./zwang " + name);
  app.footer("Examples:\n" + examples);
  app.get_formatter()->column_width(34);
}

static void add_law_option(CLI::App& app, const std::string& several,
                           const std::function<void(const std::string&)>& says) {
  app.add_option_function<std::string>(
         "--law", says,
         "how contacts with friction are read: frictionless, pyramid (four facets, a QP), convex (the cone) or "
         "coulomb" +
             several + "; default: as the problem says, which is coulomb where there is a mu > 0")
      ->type_name("WORD");
}

void add_law(CLI::App& app, std::optional<Law>& law) {
  add_law_option(app, "", [&law](const std::string& word) { law = parse_law(word); });
}

void add_laws(CLI::App& app, std::vector<Law>& laws) {
  add_law_option(app, ", or several: a,b", [&laws](const std::string& words) { laws = parse_laws(words); });
}

// CLI11's own checks let NaN pass, whole numbers that none holds become the largest, and bounds are printed with 300
// digits.
CLI::Option* within(const Range& range, CLI::Option* option) {
  std::string line = option->get_description();
  line.insert(std::min(line.find("; default"), line.size()), "; " + range.words());
  const bool whole = option->get_type_name().ends_with("INT");
  return option->description(line)->check([range, whole](const std::string& text) {
    const std::optional<double> value = number_in<double>(text);
    const bool is_one = value && range.holds(*value) && (!whole || number_in<std::uint64_t>(text));
    return is_one ? std::string() : text + " should be a " + (whole ? "whole " : "") + "number " + range.words();
  });
}

bool read(CLI::App& app, std::vector<std::string> words) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  if (!app.get_allow_extras())
    for (const std::string& word : words) {
      const std::string name = word.substr(0, word.find('='));
      if (name.starts_with("--") && std::find(names.begin(), names.end(), name) == names.end())
        throw std::invalid_argument("no option '" + name + "'" + did_you_mean(name, names) + " (" + app.get_name() +
                                    " --help lists all)");
    }
  std::reverse(words.begin(), words.end());
  try {
    app.parse(words);
  } catch (const CLI::CallForHelp&) {
    std::fputs(wrapped(app.help()).c_str(), stdout);
    return false;
  } catch (const CLI::ParseError& error) {
    std::string line = error.what();
    std::replace(line.begin(), line.end(), '\n', ' ');
    throw std::invalid_argument(line + " (" + app.get_name() + " --help)");
  }
  for (const CLI::Option* option : app.get_options())
    if (std::ranges::find(option->results(), "") != option->results().end())
      throw std::invalid_argument(option->get_name() + ": expected a value, and it is empty");
  return true;
}

std::vector<double> numbers(const std::string& option, const std::string& text) {
  std::vector<double> all;
  for (const std::string& part : split(text)) {
    const std::optional<double> value = number_in<double>(part);
    if (!value) throw std::invalid_argument(option + " " + text + ": '" + part + "' should be a number, as in 1e-6");
    all.push_back(*value);
  }
  return all;
}

}  // namespace zwang
