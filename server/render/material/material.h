// Surface materials: a principled-like model with few parameters, the values of the scene file and of MTL
// libraries.
#pragma once

#include "server/render/image/color.h"

#include <cstdint>
#include <string>

namespace chamfer {

inline constexpr std::uint32_t kNoTexture = 0xffffffffu;

/// Every weight is in [0, 1]. A surface is `metallic` metal; of the rest `transmission` is glass, and the
/// remainder a diffuse base under a specular coat. See bsdf.h for the lobes.
struct Material {
  Color baseColor{0.8f, 0.8f,
                  0.8f};  ///< diffuse albedo, metal's reflectance at normal incidence, glass's tint
  float roughness = 0.5f; ///< perceptual: GGX alpha is its square
  float metallic = 0;
  float specular =
      0.5f; ///< scales the coat's reflectance at normal incidence; 0.5 is that of `ior`, 0 no coat
  float transmission = 0;
  float ior = 1.5f;                            ///< of the inside over the outside; 1..4
  Color emission;                              ///< radiance, from both sides
  Color absorption;                            ///< per world unit, inside a transmissive solid
  std::uint32_t baseColorTexture = kNoTexture; ///< multiplies baseColor
  std::uint32_t roughnessTexture = kNoTexture; ///< multiplies roughness (its green channel)
  std::uint32_t normalTexture = kNoTexture;    ///< turns the shading normal (tangent_frame.h)
  float normalStrength = 1;                    ///< of the normal texture: 0 is flat, 1 as it is
  std::string name;

  bool emits() const { return !emission.isBlack(); }
  bool hasTexture() const {
    return baseColorTexture != kNoTexture || roughnessTexture != kNoTexture || normalTexture != kNoTexture;
  }
};

} // namespace chamfer
