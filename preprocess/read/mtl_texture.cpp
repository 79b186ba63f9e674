#include "preprocess/read/mtl_texture.h"

#include "preprocess/read/read_text.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <span>

namespace chamfer {
namespace {

enum class Values : std::uint8_t { Numbers, OnOff, Channel, Word };

struct Option {
  std::string_view word;
  Values values;
  std::size_t least, most;                   ///< values behind it
  std::array<std::string_view, 3> neutral{}; ///< values that change nothing: not worth a warning
};

constexpr Option kOptions[] = {
    {"-s", Values::Numbers, 1, 3, {}},        {"-o", Values::Numbers, 1, 3, {}},
    {"-clamp", Values::OnOff, 1, 1, {}},      {"-bm", Values::Numbers, 1, 1, {}},
    {"-imfchan", Values::Channel, 1, 1, {}},  {"-t", Values::Numbers, 1, 3, {"0", "0", "0"}},
    {"-blendu", Values::OnOff, 1, 1, {"on"}}, {"-blendv", Values::OnOff, 1, 1, {"on"}},
    {"-cc", Values::OnOff, 1, 1, {"off"}},    {"-mm", Values::Numbers, 2, 2, {"0", "1"}},
    {"-boost", Values::Numbers, 1, 1, {"0"}}, {"-texres", Values::Numbers, 1, 1, {}},
    {"-type", Values::Word, 1, 1, {}},
};

bool isValue(Values kind, std::string_view token) {
  switch (kind) {
  case Values::Numbers:
    return finiteNumber(token).has_value();
  case Values::OnOff:
    return token == "on" || token == "off";
  case Values::Channel:
    return token.size() == 1 && std::string_view("rgbmlz").find(token[0]) != std::string_view::npos;
  case Values::Word:
    return true;
  }
  return false;
}

class Parser {
public:
  explicit Parser(std::string_view rest) { splitTokens(rest, tokens_); }

  TextureStatement run() {
    for (std::size_t i = 0; i < tokens_.size();) {
      const auto* o = std::find_if(std::begin(kOptions), std::end(kOptions),
                                   [&](const Option& option) { return option.word == tokens_[i]; });
      const std::size_t count = o == std::end(kOptions) ? 0 : valuesBehind(*o, i);
      if (count == 0) {
        addToName(tokens_[i++]);
        continue;
      }
      take(*o, std::span(tokens_).subspan(i + 1, count));
      i += 1 + count;
    }
    result_.texture.file = std::move(name_);
    return std::move(result_);
  }

private:
  /// How many of the tokens behind the option are its values; 0 when they are too few, so that it is none.
  /// The statement's last token is left for the name when there is no other.
  std::size_t valuesBehind(const Option& o, std::size_t at) const {
    std::size_t count = 0;
    while (count < o.most && at + 1 + count < tokens_.size() && isValue(o.values, tokens_[at + 1 + count]))
      ++count;
    if (count > o.least && name_.empty() && at + 1 + count == tokens_.size()) --count;
    return count < o.least ? 0 : count;
  }

  /// Keeps the blanks between two words of the name as they are; an option between them is one blank.
  void addToName(std::string_view token) {
    if (!name_.empty()) {
      const std::string_view between(nameEnd_, std::size_t(token.data() - nameEnd_));
      name_ += between.find_first_not_of(" \t") == std::string_view::npos ? between : " ";
    }
    name_ += token;
    nameEnd_ = token.data() + token.size();
  }

  void take(const Option& o, std::span<const std::string_view> values) {
    MeshTexture& t = result_.texture;
    const auto pair = [&](std::array<double, 2>& out) {
      for (std::size_t i = 0; i < std::min<std::size_t>(values.size(), 2); ++i)
        out[i] = *finiteNumber(values[i]);
    };
    if (o.word == "-s")
      pair(t.scale);
    else if (o.word == "-o")
      pair(t.offset);
    else if (o.word == "-clamp")
      t.clamp = values[0] == "on";
    else if (o.word == "-imfchan")
      result_.channel = values[0];
    else if (o.word == "-bm") {
      t.strength = *finiteNumber(values[0]);
      result_.hasBumpMultiplier = true;
    } else
      notSupported(o, values);
  }

  void notSupported(const Option& o, std::span<const std::string_view> values) {
    const bool neutral =
        std::equal(values.begin(), values.end(), o.neutral.begin(),
                   o.neutral.begin() + std::ptrdiff_t(std::min(values.size(), o.neutral.size())),
                   [](std::string_view value, std::string_view same) {
                     const auto number = finiteNumber(value);
                     return number ? number == finiteNumber(same) : value == same;
                   });
    if (neutral) return;
    std::string text(o.word);
    for (const std::string_view value : values)
      text += " " + std::string(value);
    result_.notSupported.push_back(text);
  }

  std::vector<std::string_view> tokens_;
  std::string name_;
  const char* nameEnd_ = nullptr;
  TextureStatement result_;
};

} // namespace

TextureStatement parseTextureStatement(std::string_view rest) { return Parser(rest).run(); }

} // namespace chamfer
