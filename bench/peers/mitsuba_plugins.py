"""What Raylab's materials have and Mitsuba lacks, as Mitsuba plugins written in Python.

The classes derive from those of the variant in use, so they are made by
register(), after mitsuba.set_variant(). In scalar variants each of their calls
goes through the interpreter: right, but no measure of Mitsuba's speed.
"""

import drjit as dr
import mitsuba as mi

METAL = "raylab_metal"
CHECKER = "raylab_checker"


def register():
    class FuzzyMetal(mi.BSDF):
        """Metal of the One Weekend books, on both sides.

        The mirror direction r plus fuzz times a point s, uniform on the unit sphere, made a unit vector; absorbed
        where it runs into the surface. Along direction w the sphere of radius fuzz around r is met at
        t = cos ± root, root = sqrt(fuzz² - sin²), each time with density t² / (4 pi fuzz root) per steradian;
        what lies behind the origin does not count.
        """

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            self.fuzz = mi.Float(props["fuzz"])
            self.albedo = props.get_texture("albedo", 1.0)
            # Data instead of a constant in the code: one kernel then serves every fuzz.
            dr.make_opaque(self.fuzz)
            lobe = mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
            self.m_components = [lobe]
            self.m_flags = lobe

        def density(self, cosine, root):
            near = dr.maximum(cosine - root, 0.0)
            far = dr.maximum(cosine + root, 0.0)
            return (dr.square(near) + dr.square(far)) / (4.0 * dr.pi * self.fuzz * root)

        def sample(self, ctx, si, sample1, sample2, active):
            mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            offset = mi.warp.square_to_uniform_sphere(sample2)
            bs = mi.BSDFSample3f()
            bs.wo = dr.normalize(mirrored + self.fuzz * offset)
            # From the point itself: fuzz² - sin² may round to less than 0 near the rim.
            root = self.fuzz * dr.maximum(dr.abs(dr.dot(offset, bs.wo)), 1e-6)
            valid = active & (bs.wo.z * si.wi.z > 0.0)
            bs.pdf = dr.select(valid, self.density(dr.dot(mirrored, bs.wo), root), 0.0)
            bs.eta = 1.0
            bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            bs.sampled_component = mi.UInt32(0)
            return bs, dr.select(valid, self.albedo.eval(si, active), 0.0)

        def eval_pdf(self, ctx, si, wo, active):
            mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
            root2 = dr.square(self.fuzz) - dr.squared_norm(dr.cross(mirrored, wo))
            valid = active & (wo.z * si.wi.z > 0.0) & (root2 > 0.0)
            root = dr.sqrt(dr.maximum(root2, 1e-30))
            pdf = dr.select(valid, self.density(dr.dot(mirrored, wo), root), 0.0)
            return self.albedo.eval(si, active) * pdf, pdf

        def eval(self, ctx, si, wo, active):
            return self.eval_pdf(ctx, si, wo, active)[0]

        def pdf(self, ctx, si, wo, active):
            return self.eval_pdf(ctx, si, wo, active)[1]

        def to_string(self):
            return f"FuzzyMetal[fuzz={self.fuzz}]"

    class WorldChecker(mi.Texture):
        """`even` where floor(x/size) + floor(y/size) + floor(z/size) is even, else `odd`: by world position."""

        def __init__(self, props):
            mi.Texture.__init__(self, props)
            self.size = props["size"]
            self.even = props.get_texture("even", 1.0)
            self.odd = props.get_texture("odd", 0.0)

        def eval(self, si, active=True):
            cell = dr.floor(si.p / self.size)
            half = 0.5 * (cell.x + cell.y + cell.z)
            is_even = half == dr.floor(half)
            return dr.select(is_even, self.even.eval(si, active), self.odd.eval(si, active))

        def is_spatially_varying(self):
            return True

        def to_string(self):
            return f"WorldChecker[size={self.size}]"

    mi.register_bsdf(METAL, FuzzyMetal)
    mi.register_texture(CHECKER, WorldChecker)
