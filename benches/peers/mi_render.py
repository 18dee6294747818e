"""Renders a scene file with Mitsuba 3 and the two plugins that it lacks for Whitted's light.

`mi_render.py SCENE.xml PICTURE.exr THREADS FRAMES` prints its times as JSON. The first frame compiles
the scene's kernel, or fetches it from Mitsuba's cache; `render` is the median of the others.
"""

import json
import statistics
import sys
import time

start = time.perf_counter()

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")


class Phong(mi.BSDF):
    """Lambert and Phong as in envers: diffuse n·l + specular (r·l)^shininess, not divided by π.

    It scatters no further light: a path ends here, as in Whitted's model.
    """

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.diffuse = mi.Color3f(props["diffuse"])
        self.specular = mi.Color3f(props["specular"])
        self.shininess = mi.Float(props["shininess"])
        flags = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components = [flags]
        self.m_flags = flags

    def sample(self, ctx, si, sample1, sample2, active):
        return dr.zeros(mi.BSDFSample3f), mi.Color3f(0)

    def eval(self, ctx, si, wo, active):
        lit = active & (mi.Frame3f.cos_theta(si.wi) > 0) & (mi.Frame3f.cos_theta(wo) > 0)
        highlight = dr.power(dr.maximum(dr.dot(mi.reflect(si.wi), wo), 0), self.shininess)
        value = self.diffuse * mi.Frame3f.cos_theta(wo) + self.specular * highlight
        return dr.select(lit, value, 0)

    def pdf(self, ctx, si, wo, active):
        return mi.Float(0)

    def traverse(self, callback):
        pass


class Steady(mi.Emitter):
    """A point light that does not weaken with distance."""

    def __init__(self, props):
        mi.Emitter.__init__(self, props)
        self.position = mi.Point3f(props["position"])
        self.intensity = mi.Color3f(props["intensity"])
        self.m_flags = mi.EmitterFlags.DeltaPosition
        self.m_needs_sample_3 = False

    def sample_direction(self, it, sample, active):
        ds = dr.zeros(mi.DirectionSample3f)
        ds.p = self.position
        ds.time = it.time
        ds.pdf = 1
        ds.delta = True
        ds.emitter = mi.EmitterPtr(self)
        away = self.position - it.p
        ds.dist = dr.norm(away)
        ds.d = away / ds.dist
        return ds, self.intensity & active

    def pdf_direction(self, it, ds, active):
        return mi.Float(0)

    def eval_direction(self, it, ds, active):
        return self.intensity & active

    def eval(self, si, active):
        return mi.Color3f(0)

    def bbox(self):
        return mi.BoundingBox3f(self.position, self.position)

    def traverse(self, callback):
        pass


mi.register_bsdf("phong", Phong)
mi.register_emitter("steady", Steady)

(scene_file, picture, threads, frames) = sys.argv[1:]
dr.set_thread_count(int(threads))
imported = time.perf_counter()
scene = mi.load_file(scene_file)
dr.sync_thread()
loaded = time.perf_counter()


def frame():
    begin = time.perf_counter()
    image = mi.render(scene, spp=1)
    dr.eval(image)
    dr.sync_thread()
    return image, time.perf_counter() - begin


(image, first) = frame()
times = {"import": imported - start, "load": loaded - imported, "first_frame": first}
begin = time.perf_counter()
mi.util.write_bitmap(picture, image, write_async=False)
times["write"] = time.perf_counter() - begin
if int(frames) > 1:
    times["render"] = statistics.median(frame()[1] for _ in range(int(frames) - 1))
print(json.dumps(times))
