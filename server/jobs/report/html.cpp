#include "server/jobs/compare/words.h"
#include "server/jobs/report/color_map.h"
#include "server/jobs/report/json.h"
#include "server/jobs/report/report_files.h"
#include "server/jobs/report/reports.h"
#include "server/jobs/report/shown_picture.h"

#include "common/error.h"

#include <map>
#include <string_view>

namespace chamfer {
namespace {

using Json = nlohmann::ordered_json;

std::string_view reportFile(std::string_view path) {
  for (const EmbeddedFile& file : reportFiles())
    if (file.path == path) return file.bytes;
  throw Error(ErrorKind::Internal, "the report's " + std::string(path) + " is not in the program");
}

/// For JSON in a <script>: nothing in it can end the element or begin a comment. JSON has '<' in strings
/// only.
std::string forScript(const std::string& json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) {
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  }
  return text;
}

std::string forHtml(const std::string& text) {
  std::string out;
  for (const char c : validUtf8(text)) {
    if (c == '<')
      out += "&lt;";
    else if (c == '&')
      out += "&amp;";
    else
      out += c;
  }
  return out;
}

/// The template with each @NAME@ replaced; what is put in is not looked at again.
std::string filled(std::string_view form, const std::map<std::string_view, std::string>& values) {
  std::string text;
  for (std::size_t begin = 0;;) {
    const std::size_t at = form.find('@', begin);
    text += form.substr(begin, at - begin);
    if (at == std::string_view::npos) return text;
    const std::size_t end = form.find('@', at + 1);
    if (end == std::string_view::npos) throw Error(ErrorKind::Internal, "the report's template has an odd @");
    text += values.at(form.substr(at + 1, end - at - 1));
    begin = end + 1;
  }
}

Json shownJson(const ShownPicture& shown) {
  return {{"uri", pngUri(shown.image)},
          {"width", shown.image.width},
          {"height", shown.image.height},
          {"factor", shown.factor},
          {"not_finite", shown.notFinite}};
}

/// Is there anything to show, and as much as its size says?
bool isWhole(const Picture& picture) {
  return !picture.values.empty() && picture.values.size() == picture.pixels() * picture.channels;
}

bool isComparable(const Picture& a, const Picture& b) {
  return isWhole(a) && isWhole(b) && a.width == b.width && a.height == b.height && a.channels == b.channels;
}

Json sideJson(const Picture& picture, unsigned most) {
  if (!isWhole(picture)) return nullptr;
  return shownJson(shownPicture(picture, reductionFor(picture.width, picture.height, most)));
}

Json picturesJson(const CaseResult& one, unsigned most) {
  const Picture &a = one.a.mean, &b = one.b.mean;
  Json heat;
  if (isComparable(a, b)) {
    const HeatMap map = heatMapOf(a, b, one.region, reductionFor(a.width, a.height, most));
    heat = shownJson(map.picture);
    heat["largest"] = jsonNumber(map.largest);
    heat["has_left_out"] = map.hasLeftOut;
  }
  return {{"a", sideJson(a, most)}, {"b", sideJson(b, most)}, {"heat", heat}};
}

} // namespace

std::string comparisonHtml(const SuiteResult& result) {
  const MostSides most = mostSidesFor(result);
  Json pictures = Json::array();
  for (const CaseResult& one : result.cases)
    pictures.push_back(picturesJson(one, one.outcome == Outcome::Same ? most.same : most.other));
  const Json data = {{"result", suiteJson(result)},
                     {"pictures", std::move(pictures)},
                     {"gradient", mapGradient()},
                     {"not_finite_color", hexOf(kNotFiniteColor)},
                     {"left_out_color", hexOf(kLeftOutColor)},
                     {"decades", kHeatDecades}};
  return filled(reportFile("report.html"),
                {{"TITLE", forHtml(outcomeText(result.outcome()) + ": " + countsText(result))},
                 {"STYLE", std::string(reportFile("report.css"))},
                 {"DATA", forScript(textOfJson(data, -1))},
                 {"TEXT", forHtml(comparisonText(result))},
                 {"VIEWS", std::string(reportFile("report_views.js"))},
                 {"SCRIPT", std::string(reportFile("report.js"))}});
}

} // namespace chamfer
