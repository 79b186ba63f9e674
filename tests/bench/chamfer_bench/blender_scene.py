"""Runs inside Blender 3.4 (`blender -b --factory-startup --python blender_scene.py -- JOB.json`): builds one of our scenes in
Cycles, times it, and writes picture and figures.

The job: {"scene", "edges": "sharp" | "bevel-node" | "bevel-modifier", "probes", "segments", "width", "height", "samples",
"bounces", "threads", "picture", "result"}.

What is mapped how:
  material      Principled BSDF with GGX: base colour, metallic, roughness (GGX alpha is its square in both), specular so that
                the reflectance at normal incidence is ours, transmission, IOR, emission; absorption as an absorbing volume
  its base      Diffuse BSDF beside a Principled BSDF without base: Lambert's law, times what the coat leaves of even light,
                which is what our base is on average. The base of Blender 3.4's Principled BSDF gives nothing to the coat and
                is bright at grazing angles: with it, pictures came out 8 to 15 % brighter
  area light    a two-sided emitting quad, as ours: radiance = emission
  directional   a sun: strength = irradiance, angle = angular diameter
  sky           the same three colours by nodes; left to scattered rays, as ours when its contrast is low
  bounces       Cycles counts those after the first scattering: ours - 1
  filter        Blackman-Harris, radius 1.5 pixels; no clamping, denoising or adaptive sampling

What is timed: a first render builds everything (persistent data keep it), then a short and a long render of the same view are
timed; the difference of their times belongs to the difference of their samples, with neither synchronisation nor hierarchy
building in it."""
import json
import math
import pathlib
import sys
import time

import bmesh
import bpy
import mathutils


def read_obj(path):
    """Vertices, faces, material name per face (None where there is none), material libraries."""
    vertices, faces, names, libraries, current = [], [], [], [], None
    with open(path, encoding="utf-8") as lines:
        for line in lines:
            word, _, rest = line.strip().partition(" ")
            if word == "v":
                vertices.append(tuple(map(float, rest.split()[:3])))
            elif word == "f":
                faces.append([int(corner.split("/")[0]) - 1 for corner in rest.split()])
                names.append(current)
            elif word == "usemtl":
                current = rest.strip()
            elif word == "mtllib":
                libraries.append(path.parent / rest.strip())
    return vertices, faces, names, libraries


def read_mtl(path):
    """Materials in the words of scene files."""
    materials, current = {}, None
    words = {"Pr": "roughness", "Pm": "metallic", "Ni": "ior"}
    for line in path.read_text(encoding="utf-8").splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "newmtl":
            current = materials.setdefault(rest.strip(), {"name": rest.strip()})
        elif word == "Kd":
            current["base_color"] = [float(x) for x in rest.split()]
        elif word == "d":
            current["transmission"] = 1 - float(rest)
        elif word in words:
            current[words[word]] = float(rest)
    return materials


def color(value):
    return [value] * 3 if isinstance(value, (int, float)) else list(value)


def coat_reflectance(description):
    """At normal incidence, as in our material."""
    ior = description.get("ior", 1.5)
    return min(1.0, 2 * description.get("specular", 0.5) * ((ior - 1) / (ior + 1)) ** 2)


def coat_albedo(reflectance, roughness):
    """Share of even light that a GGX coat reflects: Karis' fit of the albedo by direction ("Physically Based Shading on Mobile",
    2014), averaged over the hemisphere."""
    if reflectance == 0:
        return 0.0
    x, y, z, w = (roughness * a + b for a, b in ((-1, 1), (-0.0275, 0.0425), (-0.572, 1.04), (0.022, -0.04)))
    total, steps = 0.0, 64
    for i in range(steps):
        cosine = (i + 0.5) / steps
        common = min(x * x, 2 ** (-9.28 * cosine)) * x + y
        total += 2 * cosine / steps * (reflectance * (-1.04 * common + z) + 1.04 * common + w)
    return total


class SceneBuilder:
    def __init__(self, job):
        self.job = job
        self.path = pathlib.Path(job["scene"])
        self.scene = json.loads(self.path.read_text())
        self.materials = {}  # (library or "", name, radius) -> Blender material
        self.meshes = {}  # (file, material name or None, radius) -> Blender mesh
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self.target = bpy.context.scene

    # ------------------------------------------------------------------------------------------ materials

    def material(self, library, description, radius):
        """With the Bevel node where the job says so and `radius`, in world units, is above 0."""
        key = (library, description.get("name"), radius)
        if key in self.materials:
            return self.materials[key]
        made = bpy.data.materials.new(str(description.get("name")))
        made.use_nodes = True
        nodes, links = made.node_tree.nodes, made.node_tree.links
        normals = self._add_surface(nodes, links, description)
        absorption = color(description.get("absorption", 0))
        if max(absorption) > 0:
            volume = nodes.new("ShaderNodeVolumeAbsorption")
            density = max(absorption)
            volume.inputs["Density"].default_value = density
            volume.inputs["Color"].default_value = (*(1 - a / density for a in absorption), 1)
            links.new(volume.outputs["Volume"], nodes["Material Output"].inputs["Volume"])
            made.cycles.homogeneous_volume = True
        if radius > 0 and self.job["edges"] == "bevel-node":
            bevel = nodes.new("ShaderNodeBevel")
            bevel.samples = self.job["probes"]
            bevel.inputs["Radius"].default_value = radius
            for normal in normals:
                links.new(bevel.outputs["Normal"], normal)
        self.materials[key] = made
        return made

    def _add_surface(self, nodes, links, description):
        """Connects what scatters; returns the inputs for its normal."""
        output = nodes["Material Output"].inputs["Surface"]
        principled = nodes["Principled BSDF"]
        self._set_principled(principled, description)
        if any(description.get(key, 0) for key in ("metallic", "transmission")):
            return [principled.inputs["Normal"]]
        principled.inputs["Base Color"].default_value = (0, 0, 0, 1)  # the coat alone
        left = 1 - coat_albedo(coat_reflectance(description), description.get("roughness", 0.5))
        base, both = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeAddShader")
        base.inputs["Color"].default_value = (*(left * c for c in color(description.get("base_color", 0.8))), 1)
        links.new(base.outputs["BSDF"], both.inputs[0])
        links.new(principled.outputs["BSDF"], both.inputs[1])
        links.new(both.outputs["Shader"], output)
        return [base.inputs["Normal"], principled.inputs["Normal"]]

    @staticmethod
    def _set_principled(principled, description):
        principled.distribution = "GGX"
        inputs = principled.inputs
        inputs["Base Color"].default_value = (*color(description.get("base_color", 0.8)), 1)
        inputs["Metallic"].default_value = description.get("metallic", 0)
        inputs["Roughness"].default_value = description.get("roughness", 0.5)
        inputs["Specular"].default_value = min(1.0, coat_reflectance(description) / 0.08)
        inputs["IOR"].default_value = description.get("ior", 1.5)
        inputs["Transmission"].default_value = description.get("transmission", 0)
        inputs["Emission"].default_value = (*color(description.get("emission", 0)), 1)
        inputs["Emission Strength"].default_value = 1

    def light_material(self, emission):
        made = bpy.data.materials.new("area light")
        made.use_nodes = True
        nodes = made.node_tree.nodes
        nodes.remove(nodes["Principled BSDF"])
        emitter = nodes.new("ShaderNodeEmission")
        emitter.inputs["Color"].default_value = (*color(emission), 1)
        emitter.inputs["Strength"].default_value = 1
        made.node_tree.links.new(emitter.outputs["Emission"], nodes["Material Output"].inputs["Surface"])
        return made

    # ------------------------------------------------------------------------------------------- geometry

    def mesh(self, entry, material, radius):
        key = (entry["file"], material and material["name"], radius)
        if key in self.meshes:
            return self.meshes[key]
        path = self.path.parent / entry["file"]
        vertices, faces, names, libraries = read_obj(path)
        made = bpy.data.meshes.new(entry["name"])
        made.from_pydata(vertices, [], faces)
        if material:
            made.materials.append(self.material("", material, radius))
        else:
            known = {name: m for library in libraries for name, m in read_mtl(library).items()}
            neutral = {"name": "default", "base_color": 0.6, "roughness": 0.35}
            slots = {}
            for name in names:
                if name not in slots:
                    slots[name] = len(slots)
                    made.materials.append(self.material(str(path), known.get(name, neutral), radius))
            made.polygons.foreach_set("material_index", [slots[name] for name in names])
        made.update()
        self.meshes[key] = made
        return made

    def placement(self, entry):
        """World from object."""
        if "matrix" in entry:
            m = entry["matrix"]
            return mathutils.Matrix([m[i:i + 4] for i in range(0, 16, 4)])
        size = entry.get("scale", 1)
        result = mathutils.Matrix.Diagonal((*color(size), 1))
        turns = entry.get("rotate", [])
        for turn in turns if isinstance(turns, list) else [turns]:
            result = mathutils.Matrix.Rotation(math.radians(turn["degrees"]), 4, mathutils.Vector(turn["axis"])) @ result
        return mathutils.Matrix.Translation(entry.get("translate", (0, 0, 0))) @ result

    def place(self, name, mesh, matrix):
        made = bpy.data.objects.new(name, mesh)
        made.matrix_world = matrix
        self.target.collection.objects.link(made)
        return made

    def add_instances(self):
        entries = {m["name"]: m for m in self.scene["meshes"]}
        materials = {m["name"]: m for m in self.scene.get("materials", [])}
        for instance in self.scene["instances"]:
            if "repeat" in instance:
                raise ValueError("scenes with \"repeat\" are not exported")
            entry = entries[instance["mesh"]]
            matrix = self.placement(instance)
            radius = entry.get("radius", 0)
            world_radius = radius * abs(matrix.determinant()) ** (1 / 3)
            mesh = self.mesh(entry, materials.get(instance.get("material")), round(world_radius, 9))
            placed = self.place(instance["mesh"], mesh, matrix)
            if radius > 0 and self.job["edges"] == "bevel-modifier":
                self.add_bevel(placed, mesh, radius)

    def add_bevel(self, placed, mesh, radius):
        """The modifier cuts every edge by a width times its weight: here the tangent length r tan(turn / 2) of our rounding."""
        if "bevel width" not in mesh:
            edges = bmesh.new()  # setting the weights of a mesh one by one takes quadratic time
            edges.from_mesh(mesh)
            edges.normal_update()
            lengths = [radius * math.tan(edge.calc_face_angle() / 2) for edge in edges.edges]
            mesh["bevel width"] = max(lengths)
            layer = edges.edges.layers.bevel_weight.verify()
            for edge, length in zip(edges.edges, lengths):
                edge[layer] = length / mesh["bevel width"]
            edges.to_mesh(mesh)
            edges.free()
            mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
            mesh.use_auto_smooth = True  # for harden_normals: the flats stay flat
            mesh.auto_smooth_angle = math.pi
        bevel = placed.modifiers.new("bevel", "BEVEL")
        bevel.width = mesh["bevel width"]
        bevel.limit_method = "WEIGHT"
        bevel.segments = self.job["segments"]
        bevel.use_clamp_overlap = False  # it would give every solid of the mesh what the smallest one bears
        bevel.harden_normals = True

    # ------------------------------------------------------------------------------- lights and camera

    def add_lights(self):
        has_sky = False
        for light in self.scene.get("lights", []):
            kind = light["type"]
            if kind == "area":
                centre, u, v = (mathutils.Vector(light[key]) for key in ("center", "u", "v"))
                quad = bpy.data.meshes.new("area light")
                quad.from_pydata([centre - u - v, centre + u - v, centre + u + v, centre - u + v], [], [(0, 1, 2, 3)])
                quad.materials.append(self.light_material(light["emission"]))
                self.place("area light", quad, mathutils.Matrix.Identity(4))
            elif kind == "directional":
                sun = bpy.data.lights.new("sun", "SUN")
                strength = color(light["irradiance"])
                sun.energy = max(strength)
                sun.color = [s / max(strength) for s in strength]
                sun.angle = math.radians(light.get("angular_diameter_degrees", 0))
                aim = mathutils.Vector(light["direction"]).to_track_quat("-Z", "Y").to_matrix().to_4x4()
                self.place("sun", sun, aim)
            elif kind == "sky":
                has_sky = True
                self.add_sky(color(light["zenith"]), color(light["horizon"]), color(light["ground"]))
            elif kind == "environment" and "color" in light:
                has_sky = True
                even = [c * light.get("strength", 1) for c in color(light["color"])]
                self.add_sky(even, even, even)
            else:
                raise ValueError(f"lights of type {kind} are not exported")
        if not has_sky:
            raise ValueError("the scene relies on the studio's sky; it must name its own to be exported")

    def add_sky(self, zenith, horizon, ground):
        """Ground below the horizon; above, from horizon to zenith with the root of the height."""
        world = bpy.data.worlds.new("sky")
        world.use_nodes = True
        self.target.world = world
        world.cycles.sampling_method = "NONE"
        nodes, links = world.node_tree.nodes, world.node_tree.links
        place, split = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeSeparateXYZ")
        links.new(place.outputs["Generated"], split.inputs[0])

        def math_node(operation, value):
            node = nodes.new("ShaderNodeMath")
            node.operation, node.use_clamp = operation, operation == "POWER"
            links.new(split.outputs["Z"], node.inputs[0])
            node.inputs[1].default_value = value
            return node

        def mix(factor, first, second):
            node = nodes.new("ShaderNodeMixRGB")
            links.new(factor.outputs[0], node.inputs["Fac"])
            for slot, value in (("Color1", first), ("Color2", second)):
                if isinstance(value, list):
                    node.inputs[slot].default_value = (*value, 1)
                else:
                    links.new(value.outputs[0], node.inputs[slot])
            return node

        above = mix(math_node("POWER", 0.5), horizon, zenith)
        sky = mix(math_node("GREATER_THAN", 0), ground, above)
        links.new(sky.outputs[0], nodes["Background"].inputs["Color"])

    def add_camera(self):
        description = self.scene["camera"]
        eye, target = (mathutils.Vector(description[key]) for key in ("eye", "target"))
        forward = (target - eye).normalized()
        right = forward.cross(mathutils.Vector(description.get("up", (0, 0, 1)))).normalized()
        up = right.cross(forward)
        matrix = mathutils.Matrix((right, up, -forward)).transposed().to_4x4()
        matrix.translation = eye
        data = bpy.data.cameras.new("camera")
        data.sensor_fit = "VERTICAL"
        data.angle = math.radians(description.get("vfov_degrees", 40))
        data.clip_start, data.clip_end = 1e-3, 1e6
        if description.get("aperture_diameter", 0) > 0:
            data.dof.use_dof = True
            data.dof.focus_distance = description.get("focus_distance") or (target - eye).length
            data.dof.aperture_fstop = data.lens / 1000 / description["aperture_diameter"]
        self.target.camera = self.place("camera", data, matrix)

    # ------------------------------------------------------------------------------------------- render

    def set_up_cycles(self):
        scene, job = self.target, self.job
        scene.render.engine = "CYCLES"
        scene.render.resolution_x, scene.render.resolution_y = job["width"], job["height"]
        scene.render.resolution_percentage = 100
        scene.render.threads_mode, scene.render.threads = "FIXED", job["threads"]
        scene.render.use_persistent_data = True
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        scene.view_settings.view_transform = "Standard"
        cycles = scene.cycles
        cycles.device = "CPU"
        cycles.use_adaptive_sampling = False
        cycles.use_denoising = False
        bounces = max(0, job["bounces"] - 1)
        for kind in ("max", "diffuse", "glossy", "transmission", "volume", "transparent_max"):
            setattr(cycles, f"{kind}_bounces", bounces)
        cycles.min_light_bounces = 3  # Russian roulette begins where ours does
        cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
        cycles.blur_glossy = 0
        cycles.caustics_reflective = cycles.caustics_refractive = True
        cycles.pixel_filter_type, cycles.filter_width = "BLACKMAN_HARRIS", 1.5
        cycles.use_auto_tile = False
        cycles.seed = 1

    def render(self, samples):
        """Seconds that a render takes."""
        self.target.cycles.samples = samples
        self.target.update_tag()  # persistent data would keep the number of before
        begin = time.perf_counter()
        bpy.ops.render.render()
        return time.perf_counter() - begin


def main():
    job = json.loads(pathlib.Path(sys.argv[sys.argv.index("--") + 1]).read_text())
    builder = SceneBuilder(job)
    builder.add_instances()
    builder.add_lights()
    builder.add_camera()
    builder.set_up_cycles()
    builder.render(1)
    few = max(1, job["samples"] // 4)
    short = builder.render(few)
    long = builder.render(few + job["samples"])
    bpy.data.images["Render Result"].save_render(job["picture"])
    rate = job["width"] * job["height"] * job["samples"] / (long - short)
    result = {"samples_per_second": rate, "seconds": long - short, "with_synchronisation": long,
              "blender": bpy.app.version_string}
    pathlib.Path(job["result"]).write_text(json.dumps(result))


main()
