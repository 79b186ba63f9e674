// Every fault of a scene file is refused with the path of the key and the value at fault.
#include "server/render/scene/scene_description.h"

#include "tests/render/scene_files_fixture.h"

#include <gmock/gmock.h>
#include <ostream>

namespace chamfer {

struct FaultyScene {
  const char* part; ///< replaces or joins the members of a valid scene
  const char* path; ///< what the message must name, and some of its words
  const char* words;
};
static void PrintTo(const FaultyScene& f, std::ostream* out) { *out << f.part; }

namespace {

using testing::HasSubstr;

/// A valid scene whose parts can be replaced.
std::string sceneWith(const std::string& member, const std::string& value) {
  const std::pair<const char*, const char*> parts[] = {
      {"meshes", R"([{"name":"cube","file":"cube.obj","radius":0.1},{"name":"lamp","file":"lamp.obj"}])"},
      {"materials", R"([{"name":"red","base_color":[0.5,0.1,0.1],"roughness":0.3}])"},
      {"instances", R"([{"mesh":"cube","material":"red"},{"mesh":"lamp","translate":[0,0,3]}])"},
      {"lights", R"([{"type":"area","center":[0,0,5],"u":[1,0,0],"v":[0,1,0],"emission":[9,9,9]}])"},
      {"camera", R"({"eye":[0,-5,1],"target":[0,0,0]})"}};
  std::string text;
  bool found = false;
  for (const auto& [key, standard] : parts) {
    found |= member == key;
    text += (text.empty() ? "{\"" : ",\"") + std::string(key) + "\":" + (member == key ? value : standard);
  }
  if (!found) text += ",\"" + member + "\":" + value;
  return text + "}";
}

TEST(SceneDescription, ReadsWhatItIsGiven) {
  const SceneDescription d = parseSceneDescription(
      sceneWith("instances", R"([{"mesh":"lamp","scale":[1,2,-3],"rotate":{"axis":[0,0,1],"degrees":90},
        "translate":[10,0,0]},{"mesh":"cube","material":"red","matrix":[2,0,0,1, 0,2,0,2, 0,0,2,3, 0,0,0,1],
        "repeat":[{"count":3,"step":[5,0,0]},{"count":2,"step":[0,7,0]}]}])"),
      "s");
  ASSERT_EQ(d.meshes.size(), 2u);
  EXPECT_EQ(d.meshes[0].radius->value, 0.1);
  EXPECT_FALSE(d.meshes[1].radius.has_value());
  EXPECT_FLOAT_EQ(d.materials[0].material.baseColor.r, 0.5f);
  ASSERT_EQ(d.instances.size(), 7u);
  EXPECT_EQ(d.instances[0].mesh, 1u);
  EXPECT_EQ(d.instances[0].material, kNone);
  // (1, 1, 1) scaled to (1, 2, -3), turned to (-2, 1, -3), moved.
  const Point3 p = d.instances[0].worldFromObject(Point3(1, 1, 1));
  EXPECT_NEAR(length(p - Point3(8, 1, -3)), 0, 1e-12);
  EXPECT_EQ(d.instances[1].worldFromObject(Point3(1, 1, 1)), Point3(3, 4, 5));
  EXPECT_EQ(d.instances[6].worldFromObject(Point3(1, 1, 1)), Point3(13, 11, 5));
  ASSERT_EQ(d.areaLights.size(), 1u);
  EXPECT_EQ(d.camera->vfovDegrees, 40);
}

TEST(SceneDescription, ReadsEveryKindOfLightAndRelativeRadii) {
  const SceneDescription d =
      parseSceneDescription(sceneWith("lights", R"([{"type":"point","position":[1,2,3],"intensity":5},
        {"type":"directional","direction":[0,0,-2],"irradiance":[1,2,3],"angular_diameter_degrees":0.5},
        {"type":"environment","image":"sky.exr","strength":2,"rotation_degrees":45,"up":[0,1,0]}])"),
                            "s");
  EXPECT_EQ(d.pointLights[0].intensity, grey(5));
  EXPECT_EQ(d.distantLights[0].direction, Vector3(0, 0, 1));
  EXPECT_EQ(d.environment->image, "sky.exr");
  EXPECT_EQ(d.environment->up, Vector3(0, 1, 0));
  const SceneDescription r =
      parseSceneDescription(sceneWith("meshes", R"([{"name":"cube","file":"a.obj","radius":"2%"},
        {"name":"lamp","file":"b.obj","rounding":false},{"name":"wall","file":"c.obj","radius_world":0.03,
         "radius_clamp":0.9,"up_axis":"y","on_nonconvex":"hull"}])"),
                            "s");
  EXPECT_FALSE(r.meshes[0].worldRadius || r.meshes[0].radiusClamp || r.meshes[0].onNonConvex);
  EXPECT_EQ(r.meshes[0].up, UpAxis::Z);
  EXPECT_TRUE(r.meshes[2].worldRadius);
  EXPECT_EQ(r.meshes[2].radius->value, 0.03);
  EXPECT_EQ(r.meshes[2].radiusClamp, 0.9);
  EXPECT_EQ(r.meshes[2].onNonConvex, OnNonConvex::Hull);
  EXPECT_EQ(r.meshes[2].up, UpAxis::Y);
  EXPECT_TRUE(r.meshes[0].radius->relative);
  EXPECT_DOUBLE_EQ(r.meshes[0].radius->value, 0.02);
  EXPECT_TRUE(r.meshes[1].staysSharp);
}

class FaultyScenes : public testing::TestWithParam<FaultyScene> {};

TEST_P(FaultyScenes, AreRefusedWithTheKeysPath) {
  const std::string part = GetParam().part;
  const std::size_t colon = part.find(':');
  const std::string text = sceneWith(part.substr(0, colon), part.substr(colon + 1));
  const std::string thrown = test::thrownBy([&] { parseSceneDescription(text, "test.scene.json"); });
  EXPECT_THAT(thrown,
              testing::StartsWith(std::string("malformed: test.scene.json: ") + GetParam().path + ": "));
  EXPECT_THAT(thrown, HasSubstr(GetParam().words));
}

INSTANTIATE_TEST_SUITE_P(
    OneEach, FaultyScenes,
    testing::Values(
        FaultyScene{"colour:1", "colour", "unknown key"},
        FaultyScene{"meshes:3", "meshes", "must be an array, is 3"},
        FaultyScene{"meshes:[{\"file\":\"a.obj\"}]", "meshes[0]", "\"name\" is missing"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"file\":7}]", "meshes[0].file", "string"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"file\":\"\"}]", "meshes[0].file", "not empty"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"file\":\"a\",\"radius\":0}]", "meshes[0].radius",
                    "above 0, is 0"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"file\":\"a\",\"radius\":\"wide\"}]", "meshes[0].radius",
                    "wide"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"radius\":1,\"rounding\":false}]",
                    "meshes[0].radius", "no radius"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"radius\":1,\"radius_world\":1}]",
                    "meshes[0].radius_world", "beside \"radius\""},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"radius_world\":\"2%\"}]",
                    "meshes[0].radius_world", "must be a number"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"radius_world\":1,\"rounding\":false}]",
                    "meshes[0].radius_world", "no radius"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"radius_clamp\":1}]", "meshes[0].radius_clamp",
                    "at most 0.999, is 1"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"up_axis\":\"x\"}]", "meshes[0].up_axis",
                    "\"y\" or \"z\", is \"x\""},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"scale\":1e-200}]", "instances[0].scale",
                    "a scale of 1e-200 has no inverse"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"rounding\":1}]", "meshes[0].rounding",
                    "true or false"},
        FaultyScene{"meshes:[{\"name\":\"c\",\"file\":\"a\",\"on_nonconvex\":\"drop\"}]",
                    "meshes[0].on_nonconvex", "drop"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"file\":\"a\"},{\"name\":\"cube\",\"file\":\"b\"}]",
                    "meshes[1].name", "used twice"},
        FaultyScene{"meshes:[{\"name\":\"cube\",\"name\":\"lamp\",\"file\":\"a\"}]", "meshes[0].name",
                    "given twice"},
        FaultyScene{"materials:[{\"name\":\"red\",\"roughness\":1.5}]", "materials[0].roughness",
                    "at least 0.0 and at most 1.0, is 1.5"},
        FaultyScene{"materials:[{\"name\":\"red\",\"base_color\":[1,2,0]}]", "materials[0].base_color[1]",
                    "is 2"},
        FaultyScene{"materials:[{\"name\":\"red\",\"base_color\":[1,1]}]", "materials[0].base_color",
                    "3 numbers"},
        FaultyScene{"materials:[{\"name\":\"red\",\"ior\":0.5}]", "materials[0].ior", "at least 1"},
        FaultyScene{"materials:[{\"name\":\"red\",\"metalic\":1}]", "materials[0].metalic",
                    "known here: name, base_"},
        FaultyScene{"instances:[]", "instances", "empty"},
        FaultyScene{"instances:[{\"mesh\":\"ball\"}]", "instances[0].mesh", "ball"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"material\":\"blue\"}]", "instances[0].material", "blue"},
        FaultyScene{
            "instances:[{\"mesh\":\"cube\"},{\"mesh\":\"cube\"},{\"mesh\":\"cube\",\"scale\":[0,1,1]}]",
            "instances[2].scale[0]", "inverse"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"scale\":[1,1]}]", "instances[0].scale", "array of 3"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"translate\":[1,\"2\",3]}]", "instances[0].translate[1]",
                    "must be a number, is \"2\""},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"rotate\":{\"axis\":[0,0,0],\"degrees\":3}}]",
                    "instances[0].rotate.axis", "direction"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"matrix\":[1,2,3]}]", "instances[0].matrix",
                    "16 numbers"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"matrix\":[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]}]",
                    "instances[0].matrix", "inverted"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0.5,1]}]",
                    "instances[0].matrix[14]", "last row"},
        FaultyScene{
            "instances:[{\"mesh\":\"cube\",\"scale\":2,\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]",
            "instances[0].scale", "beside"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"repeat\":[{\"count\":2.5,\"step\":[1,0,0]}]}]",
                    "instances[0].repeat[0].count", "whole number"},
        FaultyScene{"instances:[{\"mesh\":\"cube\",\"repeat\":[{\"count\":-1,\"step\":[1,0,0]}]}]",
                    "instances[0].repeat[0].count", "is -1"},
        FaultyScene{
            "instances:[{\"mesh\":\"cube\",\"repeat\":[{\"count\":9000,\"step\":[1,0,0]},{\"count\":9000,"
            "\"step\":[0,1,0]}]}]",
            "instances[0].repeat[1]", "16000000 instances"},
        FaultyScene{"lights:[{\"type\":\"laser\"}]", "lights[0].type", "laser"},
        FaultyScene{
            "lights:[{\"type\":\"area\",\"center\":[0,0,0],\"u\":[1,0,0],\"v\":[2,0,0],\"emission\":1}]",
            "lights[0].v", "parallel"},
        FaultyScene{"lights:[{\"type\":\"point\",\"position\":[0,0,0],\"intensity\":-1}]",
                    "lights[0].intensity", "at least 0"},
        FaultyScene{"lights:[{\"type\":\"sky\"},{\"type\":\"sky\"}]", "lights[1]", "already"},
        FaultyScene{"lights:[{\"type\":\"environment\"}]", "lights[0]", "either"},
        FaultyScene{"camera:{\"eye\":[0,0,0]}", "camera", "\"target\" is missing"},
        FaultyScene{"camera:{\"eye\":[0,0,0],\"target\":[0,0,0]}", "camera", "different points"},
        FaultyScene{"camera:{\"eye\":[0,0,0],\"target\":[0,0,1]}", "camera", "along the view"},
        FaultyScene{"camera:{\"eye\":[0,0,0],\"target\":[0,1,0],\"vfov_degrees\":180}", "camera",
                    "0.001 to 179"}));

TEST(SceneDescription, NamesTheLineOfBrokenJson) {
  const auto thrown = [](const std::string& text) {
    return test::thrownBy([&] { parseSceneDescription(text, "a.scene.json"); });
  };
  EXPECT_THAT(thrown("{\n\"meshes\": [,]\n}"),
              testing::StartsWith("malformed: a.scene.json:2: this is not JSON"));
  EXPECT_THAT(thrown(""), HasSubstr("a.scene.json:1: this is not JSON"));
  EXPECT_THAT(thrown("{} {}"), HasSubstr("not JSON"));
  EXPECT_THAT(thrown("{\"meshes\":[NaN]}"), HasSubstr("not JSON"));
  EXPECT_THAT(thrown("{\"camera\":{\"eye\":[1e999,0,0]}}"), HasSubstr("too large"));
  EXPECT_THAT(thrown("[" + std::string(100000, '[')), HasSubstr("nested deeper"));
  EXPECT_THAT(thrown("{\"meshes\":[{\"name\":\"\xff\"}]}"), HasSubstr("not JSON")) << "not UTF-8";
  EXPECT_THAT(thrown("3"), HasSubstr("must be an object, is 3"));
}

} // namespace
} // namespace chamfer
