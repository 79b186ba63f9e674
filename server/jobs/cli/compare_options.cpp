#include "server/jobs/cli/compare_options.h"

#include "common/error.h"
#include "server/render/request/parameters.h"

#include <functional>

namespace chamfer {
namespace {

/// Faults that our own parsers find, told as CLI11 tells its own.
void orRefuse(const std::function<void()>& read) {
  try {
    read();
  } catch (const Error& error) {
    throw CLI::ValidationError(error.what());
  }
}

template <class F>
CLI::Option* addTexts(CLI::App& command, const char* name, const char* type, const char* about, F&& read) {
  return command
      .add_option_function<std::vector<std::string>>(
          name,
          [read](const std::vector<std::string>& texts) {
            for (const std::string& text : texts)
              orRefuse([&] { read(text); });
          },
          about)
      ->type_name(type)
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// "name=number"
std::pair<std::string, double> namedNumber(const std::string& text) {
  const std::size_t equals = text.find('=');
  double number = 0;
  if (equals == std::string::npos || !CLI::detail::lexical_cast(text.substr(equals + 1), number))
    throw Error(ErrorKind::Usage, "\"" + text + "\" is not NAME=NUMBER");
  return {text.substr(0, equals), number};
}

void setLevel(PerLevel& levels, const std::string& text) {
  const auto [name, number] = namedNumber(text);
  if (!(number >= 0)) throw Error(ErrorKind::OutOfRange, text + ": must be 0 or more");
  if (name == "pixel")
    levels.pixel = number;
  else if (name == "block")
    levels.block = number;
  else if (name == "image")
    levels.image = number;
  else
    throw Error(ErrorKind::Usage, "\"" + name + "\" is none of pixel, block, image");
}

std::string metricNames() {
  std::string names;
  for (const MetricRow& row : metricRows())
    names += (names.empty() ? "" : ", ") + std::string(row.name);
  return names;
}

void addPictures(CLI::App& command, CaseChoice& one) {
  command.add_option("--width", one.width, "Of frames, pixels; default: the other side's, else 640")
      ->check(CLI::Range(1, 65536));
  command.add_option("--height", one.height, "Of frames, pixels; default: the other side's, else 360")
      ->check(CLI::Range(1, 65536));
  command.add_option("--samples", one.samples, "Of each pixel, of every seed")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  addTexts(command, "--crop", "X,Y,W,H", "Compare this rectangle only",
           [&one](const std::string& text) { one.region.crop = parsePixelRect(text); });
  command
      .add_option_function<std::string>(
          "--mask", [&one](const std::string& file) { one.region.mask = file; },
          "Image of the frame's size: only pixels above half count")
      ->type_name("FILE");
  addTexts(command, "--only", "X,Y,W,H", "Only pixels in this rectangle count; may be repeated",
           [&one](const std::string& text) { one.region.only.push_back(parsePixelRect(text)); });
  addTexts(command, "--except", "X,Y,W,H", "Pixels in this rectangle do not count; may be repeated",
           [&one](const std::string& text) { one.region.except.push_back(parsePixelRect(text)); });
}

void addJudgement(CLI::App& command, CompareCommandOptions& options) {
  CaseChoice& one = options.one;
  command
      .add_option("--seeds", one.seeds,
                  "Budget: seeds of each side, at most; 1: compare single pictures exactly; default: 128")
      ->check(CLI::Range(1u, kMostSeeds));
  command.add_option("--seconds", one.seconds, "Budget in time; default: none")->check(CLI::Range(0.0, 1e9));
  addTexts(command, "--limit", "METRIC=VALUE",
           ("Largest (psnr: least) value that is accepted; may be repeated: " + metricNames()).c_str(),
           [&one](const std::string& text) {
             const auto [name, number] = namedNumber(text);
             one.limits.emplace_back(parseMetric(name), number);
           });
  command
      .add_option("--absolute", one.tolerance.absolute,
                  "failing_share: a pixel fails beyond this, plus --relative of the reference")
      ->check(CLI::Range(0.0, 1e30));
  command.add_option("--relative", one.tolerance.relative, "failing_share: see --absolute")
      ->check(CLI::Range(0.0, 1e30));
  command.add_flag_function(
      "--statistics,!--no-statistics", [&options](std::int64_t count) { options.statistics = count > 0; },
      "Test whether the means are the same; default: where something is rendered and no limit is given");
  command.add_option("--significance", one.statistics.significance, "Share of false alarms that is accepted")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  addTexts(command, "--tolerate", "LEVEL=SHARE",
           "Differences that are none, relative to the brightness: pixel=0.1, block=0.01, image=0.001",
           [&one](const std::string& text) { setLevel(one.statistics.tolerance, text); });
  addTexts(command, "--resolution", "LEVEL=SHARE",
           "\"Same\" means that every true difference is below: pixel=1, block=0.1, image=0.005",
           [&one](const std::string& text) { setLevel(one.statistics.resolution, text); });
}

} // namespace

CLI::App* addCompareCommand(CLI::App& app, CompareCommandOptions& options) {
  CLI::App* compare =
      app.add_subcommand("compare", "Render and compare: are two sides the same, beyond their noise?");
  compare
      ->add_option(
          "sides", options.sides,
          "A, which is judged, and B, which it is judged by: SCENE[?rounding=..&radius=..&seed=..], a "
          "tile's URL (/v1/scenes/..), an image file, or for B digest:HEX")
      ->type_name("A B");
  compare->add_option("--suite", options.suite, "JSON file with cases instead of A and B");
  compare->add_option("--case", options.onlyCases, "Only this case of the suite; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  compare->add_option("--root", options.root,
                      "Folder of the scenes that URLs name; scene files may name files only below it");
  addPictures(*compare, options.one);
  addJudgement(*compare, options);
  compare->add_flag("--update", options.update, "Accept what A renders now as the new reference B");
  compare->add_option("--json", options.json, "Write the results as JSON; -: to standard output");
  compare->add_option("--junit", options.junit, "Write the results as JUnit XML");
  compare->add_option("--html", options.html, "Write a report to look at: one file, no network");
  compare->add_option("--keep", options.keep,
                      "Folder in which rendered seeds stay: a second run continues where one was stopped");
  compare->add_option("--threads", options.threads, "0: all cores")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  compare->add_flag("-q,--quiet", options.quiet, "Print nothing");
  compare->footer(
      "Exit status: 0 same, 1 differs, 2 cannot tell, or an error; the last line and the reports say "
      "which.\nExample: chamferd compare 'blocks.scene.json' 'blocks.scene.json?rounding=mesh:64' "
      "--html report.html");
  return compare;
}

} // namespace chamfer
