#include "preprocess/read/mtl_library.h"

#include "preprocess/read/mtl_texture.h"
#include "preprocess/read/read_formats.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace chamfer {
namespace {

namespace fs = std::filesystem;

/// Keys that are not used, with the numbers that leave nothing to drop.
constexpr struct {
  const char* key;
  double neutral[4];
} kNeutral[] = {
    {"ka", {0, 0, 0, 0}},     {"tf", {1, 1, 1, 1}},    {"ps", {0, 0, 0, 0}},
    {"pc", {0, 0, 0, 0}},     {"pcr", {0, 0, 0, 0}},   {"aniso", {0, 0, 0, 0}},
    {"anisor", {0, 0, 0, 0}}, {"illum", {2, 3, 5, 8}}, // highlights and reflections, as always here
};

class LibraryReader {
public:
  LibraryReader(TriangleMesh& mesh, MaterialIndex& index, ReadWarnings& warnings, fs::path file)
      : mesh_(mesh), index_(index), warnings_(warnings), file_(std::move(file)),
        name_(file_.filename().string()) {}

  void run() {
    const std::string text = readFile(file_);
    LineReader reader(withoutByteOrderMark(text, name_));
    std::string_view line;
    while (reader.next(line)) {
      line_ = reader.number();
      statement(trimmed(line));
    }
    finish();
    if (unused_.empty()) return;
    std::string list;
    for (const std::string& key : unused_)
      list += (list.empty() ? "" : ", ") + key;
    if (furtherUnused_ > 0) list += " and " + std::to_string(furtherUnused_) + " more";
    warn("unused", {name_}, "keys that are not used: " + list);
  }

private:
  enum class Use : std::uint8_t { Color, Roughness, Bump };

  /// Kinds are of this library.
  void warn(const std::string& kind, const TextPlace& place, const std::string& what) {
    warnings_.add(name_ + '\n' + kind, place, what);
  }
  void warn(const std::string& kind, const std::string& what) {
    warn(kind, {name_, line_}, "material " + inQuotes(material_->name) + ": " + what);
  }

  void statement(std::string_view line) {
    if (line.empty() || line[0] == '#') return;
    const std::string_view word = line.substr(0, std::min(line.find_first_of(" \t"), line.size()));
    const std::string_view rest = trimmed(line.substr(word.size()));
    const std::string key = lowerCase(word);
    if (key == "newmtl")
      begin(std::string(rest));
    else if (!material_)
      warn("no newmtl", {name_, line_}, inQuotes(word) + " stands before the first newmtl and is not used");
    else if (key == "kd")
      hasColor_ = color(word, rest, 1, material_->baseColor) || hasColor_;
    else if (key == "ke")
      color(word, rest, 1e6, material_->emission);
    else if (key == "pr")
      number(word, rest, 0, 1, pr_);
    else if (key == "ns")
      number(word, rest, 0, 1e6, ns_);
    else if (key == "pm")
      number(word, rest, 0, 1, material_->metallic);
    else if (key == "ni")
      number(word, rest, 1, 4, material_->ior);
    else if (key == "d")
      dissolve(word, rest);
    else if (key == "tr")
      number(word, rest, 0, 1, tr_);
    else if (key == "map_kd")
      texture(word, rest, material_->baseColorTexture, Use::Color);
    else if (key == "map_pr")
      texture(word, rest, material_->roughnessTexture, Use::Roughness);
    else if (key == "norm")
      texture(word, rest, norm_, Use::Bump);
    else if (key == "map_bump" || key == "bump")
      texture(word, rest, material_->normalTexture, Use::Bump);
    else
      unused(word, key, rest);
  }

  void begin(std::string name) {
    finish();
    materialLine_ = line_;
    material_.emplace();
    material_->name = std::move(name);
    norm_ = {};
    pr_ = ns_ = d_ = tr_ = std::nullopt;
    hasColor_ = false;
  }

  /// What needs all keys of the material.
  void finish() {
    if (!material_) return;
    line_ = std::exchange(materialLine_, line_); // for the warnings
    MeshMaterial& m = *material_;
    if (pr_)
      m.roughness = *pr_;
    else if (ns_) // the Blinn-Phong exponent: alpha^2 = 2 / (Ns + 2) (Walter et al. 2007), alpha =
                  // roughness^2
      m.roughness = std::pow(2 / (*ns_ + 2), 0.25);
    if (d_ || tr_) m.transmission = d_ ? 1 - *d_ : *tr_;
    if (d_ && tr_ && std::abs(1 - *d_ - *tr_) > 1e-3)
      warn("d and Tr", "d " + numberText(*d_) + " and Tr " + numberText(*tr_) +
                           " contradict each other (Tr is 1 - d); d counts");
    if (!d_ && tr_ == 1)
      warn("Tr 1",
           "Tr 1 without d is wholly clear; where a program has written it for wholly opaque, write d 1");
    if (!hasColor_ && !m.baseColorTexture.file.empty()) m.baseColor = {1, 1, 1};
    if (!norm_.file.empty()) m.normalTexture = norm_;
    if (m.name.empty())
      warn("no name", "a newmtl without a name is not used");
    else if (!index_.emplace(m.name, std::uint32_t(mesh_.materials.size())).second)
      warn("twice", "the name is taken by a material above it; the first counts");
    else
      mesh_.materials.push_back(std::move(m));
    material_.reset();
    line_ = materialLine_;
  }

  /// Clamped, with a warning; nothing where it is no number.
  std::optional<double> inRange(std::string_view word, std::string_view token, double least, double most) {
    const auto value = finiteNumber(token);
    if (!value) {
      warn("no number" + std::string(word),
           std::string(word) + " " + inQuotes(token) + " is not a finite number and not used");
      return std::nullopt;
    }
    if (*value < least || *value > most)
      warn("range" + std::string(word), std::string(word) + " is " + numberText(*value) + ", outside " +
                                            numberText(least) + " to " + numberText(most) +
                                            ", and is taken into it");
    return std::clamp(*value, least, most);
  }

  template <class Number>
  void number(std::string_view word, std::string_view rest, double least, double most, Number& out) {
    splitTokens(withoutComment(rest), tokens_);
    if (const auto value = inRange(word, tokens_.empty() ? std::string_view() : tokens_[0], least, most))
      out = *value;
  }

  /// r g b, or one number for all three.
  bool color(std::string_view word, std::string_view rest, double most, std::array<double, 3>& out) {
    splitTokens(withoutComment(rest), tokens_);
    if (!tokens_.empty() && (tokens_[0] == "spectral" || tokens_[0] == "xyz")) {
      warn("no rgb" + std::string(word),
           std::string(word) + " " + std::string(tokens_[0]) + " is not read; write it as r g b");
      return false;
    }
    if (tokens_.size() != 1 && tokens_.size() < 3) {
      warn("no rgb" + std::string(word), std::string(word) + " has " + std::to_string(tokens_.size()) +
                                             " numbers where 3 belong, and is not used");
      return false;
    }
    std::array<double, 3> value{};
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v =
          tokens_.size() == 1 && i > 0 ? std::optional(value[0]) : inRange(word, tokens_[i], 0, most);
      if (!v) return false;
      value[i] = *v;
    }
    out = value;
    return true;
  }

  void dissolve(std::string_view word, std::string_view rest) {
    if (rest.starts_with("-halo")) {
      warn("halo", "d -halo (clear where it faces the eye) is not supported; the number alone counts");
      rest = trimmed(rest.substr(5));
    }
    number(word, rest, 0, 1, d_);
  }

  void texture(std::string_view word, std::string_view rest, MeshTexture& out, Use use) {
    TextureStatement s = parseTextureStatement(rest);
    if (s.texture.file.empty()) {
      warn("no file", std::string(word) + " names no file and is not used");
      return;
    }
    if (s.hasBumpMultiplier && use != Use::Bump)
      warn("bm", std::string(word) + ": the option -bm has no effect here: it is for bump maps");
    // Of a roughness the green channel is used, of all else all three.
    if (!s.channel.empty() && (use != Use::Roughness || s.channel != "g"))
      s.notSupported.push_back("-imfchan " + s.channel);
    for (const std::string& option : s.notSupported)
      warn("option" + option.substr(0, option.find(' ')),
           std::string(word) + ": the option " + inQuotes(option) + " is not supported and left out");
    out = std::move(s.texture);
    out.folder = file_.parent_path();
    out.place = name_ + ":" + std::to_string(line_);
  }

  void unused(std::string_view word, const std::string& key, std::string_view rest) {
    splitTokens(withoutComment(rest), tokens_);
    for (const auto& n : kNeutral)
      if (key == n.key && !tokens_.empty() &&
          std::all_of(tokens_.begin(), tokens_.end(), [&](std::string_view t) {
            const auto value = finiteNumber(t);
            return value &&
                   std::find(std::begin(n.neutral), std::end(n.neutral), *value) != std::end(n.neutral);
          }))
        return;
    if (std::find(unusedKeys_.begin(), unusedKeys_.end(), key) != unusedKeys_.end()) return;
    constexpr std::size_t kMostKeys = 30;
    if (unusedKeys_.size() == kMostKeys) {
      ++furtherUnused_;
      return;
    }
    unusedKeys_.push_back(key);
    const bool plain = std::all_of(word.begin(), word.end(), [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    });
    unused_.push_back((plain && word.size() < 20 ? std::string(word) : inQuotes(word, 20)) + " (line " +
                      std::to_string(line_) + ")");
  }

  TriangleMesh& mesh_;
  MaterialIndex& index_;
  ReadWarnings& warnings_;
  fs::path file_;
  std::string name_;
  std::size_t line_ = 0, materialLine_ = 0;
  std::vector<std::string_view> tokens_;
  std::optional<MeshMaterial> material_;
  MeshTexture norm_;
  std::optional<double> pr_, ns_, d_, tr_;
  bool hasColor_ = false;
  std::vector<std::string> unusedKeys_, unused_;
  std::size_t furtherUnused_ = 0;
};

} // namespace

void readMaterialLibrary(const std::filesystem::path& file, TriangleMesh& mesh, MaterialIndex& index,
                         ReadWarnings& warnings) {
  LibraryReader(mesh, index, warnings, file).run();
}

} // namespace chamfer
