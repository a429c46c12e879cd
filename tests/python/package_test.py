#!/usr/bin/env python3
"""The package without sockets: codecs, fields, mirror, transactions, keys."""

import math
import pathlib
import random
import struct
import tempfile
import unittest
import warnings
from array import array

import tessera
from tessera import bulk, endpoint, keys
from tessera.blobs import CHUNK_BYTES, BlobHeap, Fetch, answer, digest
from tessera.camera import frustum, multiply, rigid
from tessera.fields import KINDS, raw_array
from tessera.film import CHANNELS, FilmTile, Rule, plane_count
from tessera.frame import Assembly
from tessera.mirror import Mirror
from tessera.parsing import parsed
from tessera.records import history_of, members_of, status_of
from tessera.proto import control_pb2, scene_pb2, session_pb2, status_pb2
from tessera.transaction import Transaction

CREATE, UPDATE, REMOVE = scene_pb2.Entry.CREATE, scene_pb2.Entry.UPDATE, scene_pb2.Entry.REMOVE

# A value of each field that is not its default.
OTHER = {
    "name": "other", "children": (2, 3), "background": 4, "render_origin": (1.0, 2.0, 3.0), "hint": "animated",
    "layers": 0x80000005, "matrix": tessera.translation(1, 2, 3), "material": 5, "indices": [(0, 1, 2)],
    "positions": [0.5] * 9, "normals": array("f", [1, 0, 0] * 3), "tangents": [0.0] * 12, "tex_coords": b"12345678",
    "colors": [1.0] * 12, "base_color": (0.5, 0.25, 0.0, 1.0),
    "base_color_texture": tessera.TextureSlot(7, (1.0, 0.5), (2.0, 2.0), 0.5), "metallic": 0.5,
    "roughness": 0.25, "metallic_roughness_texture": 7, "normal_texture": 7,
    "normal_scale": 2.0, "emission": (1.0, 2.0, 3.0), "emission_texture": 7, "alpha_mode": "blend", "alpha_cutoff": 0.25,
    "double_sided": True, "unlit": True, "index_of_refraction": 1.25, "transmission": 0.5, "width": 4, "height": 2,
    "format": "rgb_float", "wrap_s": "clamp", "wrap_t": "mirror", "filter": "nearest", "texels": bytes(8),
    "kind": "spot", "intensity": (5.0, 4.0, 3.0), "inner_cone_angle": 0.25, "outer_cone_angle": 0.5,
    "vertical_fov": 1.25, "aspect_ratio": 1.5, "color": (0.5, 0.25, 0.0), "environment": 9, "strength": 2.0,
    "rotation": 0.5, "key": "k", "value": "v",
    "motion": (tessera.translation(1, 2, 3), tessera.translation(4, 5, 6)), "motion_positions": [[0.5] * 9, [0.25] * 9],
    "motion_normals": [b"123456789012"], "depth": 3, "tex_coords_1": b"12345678", "medium": 6, "radius": 0.5, "size": (2.0, 3.0), "angle": 0.25,
    "projection": "orthographic", "orthographic_height": 3.0, "lens_radius": 0.5, "focus_distance": 4.0,
    "aperture": "gaussian", "visible": "color", "map_center": "negative_z", "visible_color": (0.5, 0.25, 0.0, 1.0),
    "transmission_texture": 7, "thickness": 0.25, "attenuation_color": (0.5, 0.25, 0.0), "attenuation_distance": 0.25,
    "specular": 0.25, "specular_texture": 7, "specular_color": (0.5, 0.25, 0.0), "specular_color_texture": 7,
    "clearcoat": 0.25, "clearcoat_texture": 7, "clearcoat_roughness": 0.25, "clearcoat_roughness_texture": 7,
    "clearcoat_normal_texture": 7, "clearcoat_normal_scale": 0.25, "sheen_color": (0.5, 0.25, 0.0),
    "sheen_color_texture": 7, "sheen_roughness": 0.25, "sheen_roughness_texture": 7, "anisotropy": 0.25,
    "anisotropy_rotation": 0.25, "anisotropy_texture": 7, "iridescence": 0.25, "iridescence_texture": 7,
    "iridescence_index_of_refraction": 0.25, "iridescence_thickness_minimum": 0.25,
    "iridescence_thickness_maximum": 0.25, "iridescence_thickness_texture": 7, "shadow_catcher": True,
    "ambient": (0.5, 0.25, 0.0), "ambient_texture": 7, "diffuse": (0.5, 0.25, 0.0), "diffuse_texture": 7,
    "shininess": (0.5, 0.25), "shininess_texture": 7, "alpha": 0.25, "alpha_texture": 7, "invert_alpha_texture": True,
    "normal_format": "snorm", "normal_space": "object", "normal_bias": (0.5, 0.25, 0.0), "height_texture": 7,
    "height_scale": 0.25, "reflection": (0.5, 0.25, 0.0), "reflection_texture": 7,
    "relative_index_of_refraction": (0.5, 0.25, 0.0), "fresnel_blend": 0.25, "tangent_tex_coords": -5,
    "binormal_tex_coords": -5, "environment_texture": 7, "absorption": (0.5, 0.25, 0.0), "absorption_texture": 7,
    "scattering": (0.5, 0.25, 0.0), "scattering_texture": 7, "priority": -5,
}


# Fields of one name whose types differ.
OTHER_OF_KIND = {
    ("surface_shader", "specular"): (0.5, 0.25, 0.0), ("surface_shader", "normal_scale"): (0.5, 0.25, 0.0),
    ("surface_shader", "transmission"): (0.5, 0.25, 0.0), ("surface_shader", "environment"): (0.5, 0.25, 0.0),
}


def other(kind, name):
    return OTHER_OF_KIND.get((kind.name, name), OTHER[name])


class Fields(unittest.TestCase):
    def test_names_and_numbers_are_those_of_the_messages(self):
        for kind in KINDS:
            message = getattr(scene_pb2, kind.type.__name__)
            self.assertEqual([(f.name, 1 << (f.number - 1)) for f in message.DESCRIPTOR.fields], list(kind.bits.items()))
            self.assertEqual(list(kind.codecs), list(kind.bits))

    def test_film_channels_are_in_enum_order(self):
        self.assertEqual(CHANNELS[0], ("radiance", Rule.MOMENTS, 3))
        self.assertEqual(CHANNELS[6], ("object_id", Rule.NEAREST, 2))
        self.assertEqual(len({name for name, _, _ in CHANNELS}), len(CHANNELS))

    def test_every_field_round_trips(self):
        for kind in KINDS:
            for name in kind.codecs:
                with self.subTest(kind=kind.name, field=name):
                    heap = BlobHeap()
                    message = kind.default_message(9, heap)
                    kind.write(message, name, other(kind, name), heap)
                    again = type(message).FromString(message.SerializeToString())
                    value = getattr(kind.read(9, again), name)
                    self.assertNotEqual(value, getattr(kind.type(9), name))
                    if name.startswith("motion_"):
                        self.assertEqual([heap.blobs[blob.hash] for blob in value],
                                         [raw_array(step, "f") for step in other(kind, name)])
                    elif isinstance(value, tessera.Blob):
                        self.assertEqual(digest(heap.blobs[value.hash]), value.hash)
                    elif isinstance(value, tessera.TextureSlot):
                        self.assertEqual(value.texture, 7)
                    else:
                        self.assertEqual(value, other(kind, name))

    def test_errors_name_field_and_cause(self):
        wrong = [("material", "roughness", "rough", "material.roughness: expected a number"),
                 ("material", "roughness", math.nan, "finite"), ("material", "roughness", 1e300, "too large"),
                 ("material", "roughness", True, "number"), ("material", "base_color", (1, 2), "4 numbers, not 2"),
                 ("material", "base_color", 1, "list"), ("material", "double_sided", 1, "True or False"),
                 ("material", "alpha_mode", "glass", "one of opaque, mask, blend"), ("light", "kind", 0, "point"),
                 ("transform", "children", "lamp", "list"), ("transform", "children", ["lamp"], "an object, its id"),
                 ("transform", "matrix", (1.0,) * 15, "16 numbers"),
                 ("transform", "motion", [(1.0,) * 15], "matrices of 16 numbers"),
                 ("geometry", "motion_positions", [["a"]], "array"), ("camera", "name", 5, "text"),
                 ("geometry", "indices", [(0, -1, 2)], "whole numbers"), ("geometry", "positions", "abc", "array"),
                 ("geometry", "positions", [["a"]], "array"), ("texture", "width", -1, "whole number"),
                 ("material", "rougness", 1.0, "did you mean 'roughness'"), ("light", "xyz", 1, "it has name")]
        for kind, field, value, text in wrong:
            with self.subTest(field=field, value=value), self.assertRaisesRegex(tessera.InvalidInput, text):
                of = next(k for k in KINDS if k.name == kind)
                of.write(of.default_message(2, BlobHeap()), field, value, BlobHeap())

    def test_all_array_types_have_the_same_bytes(self):
        expected = struct.pack("<4f", 0, 1, 2, 3)
        for value in ([0, 1, 2, 3], [(0, 1), (2, 3)], array("f", range(4)), array("d", range(4)), expected,
                      memoryview(array("f", range(4))), (float(i) for i in range(4))):
            self.assertEqual(raw_array(value, "f"), expected)
        self.assertEqual(raw_array(array("q", [1, 2]), "I"), struct.pack("<2I", 1, 2))


class Bulk(unittest.TestCase):
    FILM = FilmTile(0, 0, 2, 2, 1, struct.pack("<4I", 1, 2, 3, 4), bytes(4 * 4 * 6))
    MESSAGES = [
        bulk.BulkHello(5), bulk.BlobRequest(bytes(32), 7), bulk.BlobChunk(bytes(32), 10, 3, b"abc"),
        bulk.BlobAbsent(bytes(32)), bulk.FrameTile(3, 0, 2, FILM), bulk.PictureChunk(3, 10, 3, b"abc"),
        bulk.FrameHeader(1, 2, 3, 4, 5, 1, 8, 4, 3, 2, 10, 0, 0, 8, 4, 1, 0, 1, 2, 3, bytes(32), 1.5, 0.25),
    ]

    def test_round_trip(self):
        for message in self.MESSAGES:
            self.assertEqual(bulk.decode(bulk.encode(message)), message)

    def test_truncated_or_too_long_is_malformed(self):
        for message in self.MESSAGES:
            data = bulk.encode(message)
            has_data = isinstance(message, (bulk.BlobChunk, bulk.PictureChunk))
            for cut in range(len(data) - (3 if has_data else 0)):
                with self.assertRaises(tessera.Malformed):
                    bulk.decode(data[:cut])
            with self.assertRaises(tessera.Malformed):
                bulk.decode(data + bytes(8))

    def test_decoders_survive_arbitrary_bytes(self):
        source = random.Random(1)
        members = control_pb2.Control(members=session_pb2.Members(request=1, content=session_pb2.MembersInScene(
            members=[session_pb2.Member(name=b"a")]))).SerializeToString()
        status = status_pb2.StatusReply(status=status_pb2.ClusterStatus(
            nodes=[status_pb2.NodeStatus(phase=1)])).SerializeToString()
        changes = Mirrors.changes([Mirrors.entry(5, CREATE, "light", name=b"a"),
                                   Mirrors.entry(6, CREATE, "material", name=b"b")]).SerializeToString()
        kinds = {"malformed": 0, "fine": 0}
        for round_ in range(20000):
            data = bytearray(source.choice((*map(bulk.encode, self.MESSAGES), members, status, changes)))
            for _ in range(source.choice((1, 1, 3))):
                data[source.randrange(len(data))] = source.randrange(256)
            data = bytes(data[:source.randrange(len(data) + 1)] if round_ % 3 == 0 else data)
            for decode in (self.bulk_message, self.control_message, self.change_list, self.status_message):
                try:
                    decode(data)
                    kinds["fine"] += 1
                except tessera.Malformed:
                    kinds["malformed"] += 1
        self.assertGreater(min(kinds.values()), 1000)

    @staticmethod
    def bulk_message(data):
        message = bulk.decode(data)
        assembly = Assembly(bulk.FrameHeader(1, 3, 3, 4, 5, 1, 8, 4, 3, 2, 10, 0, 0, 8, 4, 2, 0, 1, 2, 3, bytes(32)), (8, 4), 0.0)
        if isinstance(message, bulk.FrameHeader):
            assembly = Assembly(message, (8, 4), 0.0)
        if isinstance(message, (bulk.PictureChunk, bulk.FrameTile)):
            assembly.add(message, 0.0)
        frame = assembly.frame()
        if frame.tiles:
            frame.film().counts

    @staticmethod
    def control_message(data):
        message = parsed(control_pb2.Control, data)
        members_of(message.members)
        history_of(message.history)

    @staticmethod
    def status_message(data):
        status_of(parsed(status_pb2.StatusReply, data))

    @staticmethod
    def change_list(data):
        mirror = Mirror()
        mirror.apply(parsed(scene_pb2.ChangeList, data))
        for number in mirror.ids():
            mirror.value(number)
            mirror.path(number)

    def test_header_alone_allocates_no_memory(self):
        huge = bulk.FrameHeader(1, 1, 1, 1, 1, 1, 65536, 65536, 3, 2, 1 << 30, 0, 0, 65536, 65536, 1 << 20, 0, 1, 1, 1,
                                bytes(32))
        assembly = Assembly(bulk.decode(bulk.encode(huge)), None, 0.0)
        self.assertLess(len(assembly.picture) + len(assembly.tiles), 1)
        with self.assertRaises(tessera.Malformed):
            Assembly(huge, (640, 360), 0.0)

    def test_blob_is_fetched_in_chunks_and_verified(self):
        data = bytes(range(256)) * 20000
        fetch = Fetch(tessera.Blob(digest(data), len(data)))
        while not fetch.is_done:
            requests = fetch.due(0.0)
            self.assertTrue(requests)
            for request in requests:
                chunk = answer(request, data)
                self.assertLessEqual(len(chunk.data), CHUNK_BYTES)
                fetch.receive(chunk, 0.0)
        self.assertEqual(bytes(fetch.data), data)
        bad = Fetch(tessera.Blob(digest(b"good"), 4))
        bad.due(0.0)
        with self.assertRaisesRegex(tessera.Malformed, "wrong hash"):
            bad.receive(bulk.BlobChunk(digest(b"good"), 4, 0, b"evil"), 0.0)
        self.assertEqual(len(bad.due(0.0)), 1)  # again from the start
        lost = Fetch(tessera.Blob(digest(data), len(data)))
        self.assertEqual(lost.due(0.0), lost.due(10.0))  # no answer: asked again
        self.assertEqual(lost.due(10.5), [])
        self.assertEqual(answer(bulk.BlobRequest(digest(b""), 0), None), bulk.BlobAbsent(digest(b"")))


class Mirrors(unittest.TestCase):
    @staticmethod
    def entry(number, action, word="", mask=0, **values):
        entry = scene_pb2.Entry(id=number, action=action, mask=mask)
        if word:
            of = next(k for k in KINDS if k.name == word)
            target = getattr(entry.object, word)
            if action == CREATE:
                target.CopyFrom(of.default_message(number, BlobHeap()))
            for name, value in values.items():
                setattr(target, name, value)
            target.SetInParent()
        return entry

    @staticmethod
    def changes(entries, known=(0, 0), to=(1, 2)):
        changes = scene_pb2.ChangeList(entries=entries)
        changes.to.epoch, changes.to.number = to
        getattr(changes, "from").epoch, getattr(changes, "from").number = known
        return changes

    def setUp(self):
        self.mirror = Mirror()
        names = [(2, "lamp"), (3, "lamp"), (4, "sun"), (5, ""), (6, "a@b/c")]
        self.mirror.apply(self.changes([self.entry(1, CREATE, "root")] + [
            self.entry(i, CREATE, "light", name=name.encode()) for i, name in names]))

    def test_paths_round_trip(self):
        for number, path in ((1, "root"), (2, "lights/lamp@2"), (4, "lights/sun"), (5, "lights/@5"),
                             (6, "lights/a@b/c")):
            self.assertEqual(self.mirror.path(number), path)
            self.assertEqual(self.mirror.find(path), number)
        self.assertEqual(self.mirror.find("light/sun"), 4)
        for path, text in (("lights/lamp", "lights/lamp@2, lights/lamp@3"), ("lights/snu", "did you mean lights/sun"),
                           ("ligths/sun", "did you mean 'light'"), ("sun", "not a path"), ("lights/lamp@4", "has no"),
                           ("materials/sun", "has no")):
            with self.subTest(path=path), self.assertRaisesRegex(tessera.InvalidInput, text):
                self.mirror.find(path)

    def test_updates_change_fields_and_names(self):
        before = self.mirror.value(4)
        self.mirror.apply(self.changes([self.entry(4, UPDATE, "light", mask=1 | 2, name=b"moon", kind=1),
                                        self.entry(2, REMOVE)], (1, 2), (1, 3)))
        after = self.mirror.value(4)
        self.assertEqual((after.name, after.kind, after.intensity), ("moon", "spot", before.intensity))
        self.assertEqual(self.mirror.path(3), "lights/lamp")  # alone now
        self.assertNotIn(2, self.mirror)
        self.assertEqual(self.mirror.version, (1, 3))

    def test_invalid_changes_clear_the_mirror(self):
        for entry in (self.entry(9, REMOVE), self.entry(2, CREATE, "light"), self.entry(9, UPDATE, "light", mask=1),
                      self.entry(2, UPDATE, "camera", mask=1), self.entry(2, UPDATE, "light", mask=1 << 20),
                      scene_pb2.Entry(id=2, action=UPDATE)):
            self.setUp()
            with self.assertRaises(tessera.Malformed):
                self.mirror.apply(self.changes([entry], (1, 2), (1, 3)))
            self.assertEqual((self.mirror.version, len(self.mirror)), ((0, 0), 0))
        self.setUp()
        with self.assertRaises(tessera.Malformed):
            self.mirror.apply(self.changes([], (1, 7), (1, 8)))

    def test_wrong_shapes_are_malformed_on_read(self):
        self.mirror.apply(self.changes([scene_pb2.Entry(id=7, action=CREATE, object=scene_pb2.Object(
            light=scene_pb2.Light(kind=9, intensity=[1])))], (1, 2), (1, 3)))
        with self.assertRaises(tessera.Malformed):
            self.mirror.value(7)


class Scripted:
    """What a transaction needs of a session."""

    def __init__(self, mirror):
        self._mirror, self._next = mirror, 100

    def mirror(self):
        return self._mirror

    def new_id(self):
        self._next += 1
        return self._next


class Transactions(unittest.TestCase):
    def setUp(self):
        mirror = Mirror()
        root = Mirrors.entry(1, CREATE, "root")
        root.object.root.children.append(2)
        mirror.apply(Mirrors.changes([root, Mirrors.entry(2, CREATE, "transform", name=b"wheel"),
                                      Mirrors.entry(3, CREATE, "material", name=b"red")]))
        self.edit = Transaction(Scripted(mirror))

    def entries(self):
        return {entry.id: entry for entry in self.edit.entries()}

    def test_each_object_has_one_entry(self):
        lamp = self.edit.create("lights", name="lamp", kind="spot", intensity=(5, 5, 5))
        self.assertEqual((lamp.kind, lamp.intensity), ("spot", (5.0, 5.0, 5.0)))
        self.assertAlmostEqual(lamp.outer_cone_angle, math.pi / 4, 6)
        self.edit.set(lamp, kind="point")
        self.edit.set("materials/red", metallic=0.5)
        self.edit.set("materials/red", roughness=0.5)
        entries = self.entries()
        self.assertEqual(entries[lamp.id].action, CREATE)
        self.assertEqual(entries[lamp.id].object.light.kind, 0)
        self.assertEqual(entries[3].mask, 1 << 3 | 1 << 4)
        self.assertEqual(list(entries[1].object.root.children), [2, lamp.id])
        self.assertEqual(entries[1].mask, 2)

    def test_where_a_new_object_is_attached(self):
        held = self.edit.create("light")
        nowhere = self.edit.create("light", parent=None)
        placed = self.edit.create("light", parent="transforms/wheel")
        stand = self.edit.create("transform", children=[held])
        entries = self.entries()
        self.assertEqual(list(entries[1].object.root.children), [2, stand.id])
        self.assertEqual(list(entries[2].object.transform.children), [placed.id])
        self.assertIn(nowhere.id, entries)
        with self.assertRaisesRegex(tessera.InvalidInput, "no place in the graph"):
            self.edit.create("material", parent="root")
        with self.assertRaisesRegex(tessera.InvalidInput, "no children"):
            self.edit.attach(held, "materials/red")

    def test_removing(self):
        lamp = self.edit.create("light")
        self.edit.remove(lamp)
        self.edit.detach("transforms/wheel")
        self.edit.remove("transforms/wheel")
        entries = self.entries()
        self.assertEqual({i: e.action for i, e in entries.items()}, {1: UPDATE, 2: REMOVE})
        self.assertEqual(list(entries[1].object.root.children), [])
        for change in (lambda: self.edit.remove("transforms/wheel"), lambda: self.edit.set(2, name="x"),
                       lambda: self.edit.remove("root"), lambda: self.edit.set(77, name="x"),
                       lambda: self.edit.create("root"), lambda: self.edit.create("ligth")):
            with self.assertRaises(tessera.InvalidInput):
                change()


class Cameras(unittest.TestCase):
    def test_look_at_is_rigid(self):
        pose = tessera.look_at((1, 2, 8), (1, 2, 3))
        self.assertEqual(pose.world_from_camera, tessera.translation(1, 2, 8))
        pose = tessera.look_at((3, 4, 5), (-1, 0, 2))
        m = pose.world_from_camera
        for i in range(3):
            for j in range(3):
                self.assertAlmostEqual(sum(m[4 * i + k] * m[4 * j + k] for k in range(3)), float(i == j), 12)
        for bad in (((0, 0, 0), (0, 0, 0)), ((0, 0, 0), (0, 1, 0)), ((0, 0), (0, 1, 0)), ((0, 0, math.inf), (0, 1, 0))):
            with self.assertRaises(tessera.InvalidInput):
                tessera.look_at(*bad)

    def test_camera_scale_is_removed(self):
        scaled = multiply(tessera.look_at((3, 4, 5), (-1, 0, 2)).world_from_camera,
                          (2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 0, 0, 0, 1))
        for a, b in zip(rigid(scaled), tessera.look_at((3, 4, 5), (-1, 0, 2)).world_from_camera):
            self.assertAlmostEqual(a, b, 12)

    def test_the_frustum_has_square_pixels(self):
        left, right, bottom, top = frustum(1.0, 640, 360)
        self.assertAlmostEqual((right - left) / (top - bottom), 640 / 360)
        self.assertAlmostEqual(top, math.tan(0.5))


class Keys(unittest.TestCase):
    KEY = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7"

    def test_a_folder_and_an_exported_file(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file in ("anna.public", "anna.secret", "master.public"):
                (folder / file).write_text(self.KEY + "\n")
            (folder / "anna.secret").chmod(0o644)
            with self.assertRaisesRegex(tessera.Refused, "chmod 600"):
                keys.load(folder, "anna")
            (folder / "anna.secret").chmod(0o600)
            self.assertEqual(keys.load(folder, "anna"), keys.ClientKeys(self.KEY, self.KEY, self.KEY))
            self.assertNotIn("secret", repr(keys.load(folder, "anna")))
            for user, text in (("bert", "no secret key"), ("../anna", "not the name")):
                with self.assertRaisesRegex(tessera.InvalidInput, text):
                    keys.load(folder, user)
            export = folder / "anna.key"
            export.write_text("# one\n" + "".join(f'{k} = "{self.KEY}"\n' for k in ("public", "secret", "master")))
            export.chmod(0o600)
            self.assertEqual(keys.load(export, "any").master, self.KEY)
            for damaged in ("public = x\n", f'public = "{self.KEY}"\n', 'public = "short"\nsecret=""\nmaster=""\n'):
                export.write_text(damaged)
                with self.assertRaises(tessera.InvalidInput):
                    keys.load(export, "any")

    def test_addresses(self):
        place = endpoint.parse("tcp://localhost:7420")
        self.assertEqual((place.control, place.bulk), ("tcp://127.0.0.1:7420", "tcp://127.0.0.1:7421"))
        endpoint.require_keys(place, False)
        self.assertTrue(endpoint.parse("tcp://[::1]:7420").is_ipv6)
        for bad in ("localhost:7420", "tcp://a:0", "tcp://a:65535", "tcp://:7420", "udp://a:1", "tcp://a:b"):
            with self.assertRaises(tessera.InvalidInput):
                endpoint.parse(bad)
        with self.assertRaisesRegex(tessera.Refused, "nothing is encrypted"):
            endpoint.require_keys(endpoint.parse("tcp://render.example:7420"), False)


if __name__ == "__main__":
    warnings.simplefilter("ignore", RuntimeWarning)
    unittest.main(warnings="ignore")
