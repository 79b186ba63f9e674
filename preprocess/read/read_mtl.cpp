#include "preprocess/read/read_mtl.h"

#include "common/error.h"
#include "preprocess/read/read_formats.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

namespace chamfer {
namespace {

using Keys = std::set<std::string, std::less<>>;

/// Which keys each material has: tinyobjloader returns 0 for those that are missing, as for those that are 0.
std::map<std::string, Keys> keysOfMaterials(const std::string& text) {
  std::map<std::string, Keys> all;
  Keys* keys = nullptr;
  LineReader reader(text);
  std::string_view line;
  std::vector<std::string_view> tokens;
  while (reader.next(line)) {
    splitTokens(line, tokens);
    if (tokens.empty()) continue;
    if (tokens[0] == "newmtl" && tokens.size() > 1)
      keys = &all[std::string(tokens[1].data(), tokens.back().data() + tokens.back().size())];
    else if (keys)
      keys->emplace(tokens[0]);
  }
  return all;
}

class Converter {
public:
  Converter(const std::string& library, MaterialTable& table) : library_(library), table_(table) {}

  MeshMaterial operator()(const tinyobj::material_t& m, const Keys& keys) {
    MeshMaterial r;
    r.name = m.name;
    const auto has = [&](std::string_view key) { return keys.find(key) != keys.end(); };
    for (std::size_t i = 0; i < 3; ++i) {
      if (has("Kd") || has("map_Kd")) r.baseColor[i] = value(m, "Kd", m.diffuse[i], 0, 1, r.baseColor[i]);
      if (has("Ke")) r.emission[i] = value(m, "Ke", m.emission[i], 0, 1e6, 0);
    }
    // From the Blinn-Phong exponent: alpha^2 = 2 / (Ns + 2) (Walter et al. 2007), alpha = roughness^2.
    if (has("Pr"))
      r.roughness = value(m, "Pr", m.roughness, 0, 1, r.roughness);
    else if (has("Ns"))
      r.roughness = std::pow(2 / (value(m, "Ns", m.shininess, 0, 1e6, 30) + 2), 0.25);
    if (has("Pm")) r.metallic = value(m, "Pm", m.metallic, 0, 1, 0);
    if (has("d") || has("Tr")) r.transmission = 1 - value(m, "d", m.dissolve, 0, 1, 1);
    if (has("Ni")) r.ior = value(m, "Ni", m.ior, 1, 5, r.ior);
    r.baseColorTexture = m.diffuse_texname;
    r.roughnessTexture = m.roughness_texname;
    r.normalTexture = m.normal_texname.empty() ? m.bump_texname : m.normal_texname;
    return r;
  }

private:
  double value(const tinyobj::material_t& m, const char* key, double v, double least, double most,
               double otherwise) {
    if (v >= least && v <= most) return v;
    std::ostringstream text;
    text << library_ << ": material " << inQuotes(m.name) << ": " << key << " is " << v << ", outside "
         << least << " to " << most;
    table_.warnings.push_back(text.str());
    return std::isfinite(v) ? std::clamp(v, least, most) : otherwise;
  }

  const std::string& library_;
  MaterialTable& table_;
};

void addLibrary(const std::string& name, const std::filesystem::path& file, MaterialTable& table) {
  const std::string text = readFile(file);
  std::istringstream stream(text);
  std::map<std::string, int> index;
  std::vector<tinyobj::material_t> materials;
  std::string warning, error;
  tinyobj::LoadMtl(&index, &materials, &stream, &warning, &error);
  const auto keys = keysOfMaterials(text);
  Converter convert(name, table);
  for (const tinyobj::material_t& m : materials) {
    const auto found = keys.find(m.name);
    if (m.name.empty() || found == keys.end() || table.index.count(m.name) > 0) continue;
    table.index.emplace(m.name, std::uint32_t(table.materials.size()));
    table.materials.push_back(convert(m, found->second));
  }
}

/// Where a library of this name would lie; empty when that is outside of `folder`.
std::filesystem::path placeOf(std::string name, const std::filesystem::path& folder) {
  std::replace(name.begin(), name.end(), '\\', '/');
  const std::filesystem::path relative = std::filesystem::path(name).lexically_normal();
  if (relative.empty() || relative.is_absolute() || *relative.begin() == "..") return {};
  return folder / relative;
}

/// Is it a regular file, in `folder` even if links are followed?
bool readable(const std::filesystem::path& file, const std::filesystem::path& folder) {
  std::error_code error;
  if (file.empty() || !std::filesystem::is_regular_file(file, error)) return false;
  const auto top = std::filesystem::canonical(folder.empty() ? "." : folder, error);
  const auto real = error ? std::filesystem::path() : std::filesystem::canonical(file, error);
  return !error && std::mismatch(top.begin(), top.end(), real.begin(), real.end()).first == top.end();
}

} // namespace

void readMaterialLibraries(const std::string& line, const std::filesystem::path& folder,
                           MaterialTable& table) {
  std::vector<std::string> names{line};
  if (!readable(placeOf(line, folder), folder)) {
    std::vector<std::string_view> tokens;
    splitTokens(line, tokens);
    names.assign(tokens.begin(), tokens.end());
  }
  for (const std::string& name : names) {
    const std::filesystem::path file = placeOf(name, folder);
    if (!file.empty()) table.files.push_back(file);
    try {
      if (!readable(file, folder))
        table.warnings.push_back("material library " + inQuotes(name) + " is not there; none is used");
      else
        addLibrary(name, file, table);
    } catch (const Error& error) {
      table.warnings.push_back(error.what());
    }
  }
}

} // namespace chamfer
