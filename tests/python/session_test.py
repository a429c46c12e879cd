#!/usr/bin/env python3
"""A session against a scripted master: protocol messages, and recovery from timeouts, restarts and malformed data."""

import logging
import random
import struct
import threading
import time
import unittest
from array import array

import tessera
from scripted_master import ScriptedMaster
from tessera import bulk
from tessera.proto import control_pb2, scene_pb2
from with_master import WithMaster, connect

logging.disable(logging.CRITICAL)


class Greeting(unittest.TestCase):
    def test_no_answer(self):
        start = time.monotonic()
        with self.assertRaisesRegex(tessera.Unavailable, "is it running there"):
            tessera.connect("tcp://127.0.0.1:1", connect_limit=0.3)
        self.assertGreaterEqual(time.monotonic() - start, 0.3)

    def test_a_refused_hello_ends_with_the_reason(self):
        with ScriptedMaster() as master:
            master.refuse_hello = True
            with self.assertRaisesRegex(tessera.Refused, "too many sessions"):
                connect(master)

    def test_a_scene_has_to_be_joined_first(self):
        with ScriptedMaster() as master, connect(master) as session:
            self.assertEqual(session.status().software, "scripted")
            with self.assertRaisesRegex(tessera.InvalidInput, "join"):
                session.members()

    def test_closed_session_raises(self):
        with ScriptedMaster() as master:
            session = connect(master)
            session.close()
            session.close()
            master.wait_for(lambda: "goodbye" in master.received)
            with self.assertRaisesRegex(tessera.InvalidInput, "closed"):
                session.status()

    def test_heartbeats_continue_while_the_caller_sleeps(self):
        with ScriptedMaster() as master, connect(master):
            time.sleep(12 * master.interval)
            self.assertGreaterEqual(len(master.heartbeats), 5)
            self.assertEqual(len(master.members), 1)
            sent, echo, delay, came = master.heartbeats[-1]
            self.assertLessEqual(echo + delay, sent)  # one host, one clock: it heard before it spoke
            self.assertLessEqual(sent, came)
            self.assertGreaterEqual(delay, 0)


class Editing(WithMaster):
    def test_created_objects_can_be_read(self):
        red = self.create_red()
        self.assertEqual(self.scene["materials/red"], red)
        self.assertEqual(red.base_color, (1.0, 0.0, 0.0, 1.0))
        self.assertEqual(self.scene.get(tessera.Material, "red"), red)
        self.assertEqual(self.scene.path(red), "materials/red")
        self.assertIn("materials/red", self.scene)
        self.assertEqual(self.session.title, "room")

    def test_set_sends_only_given_fields(self):
        red = self.create_red()
        with self.session.transaction() as edit:
            edit.set("materials/red", roughness=0.25)
            edit.set(red, base_color=(0.5, 0, 0, 1))
        entry, = self.master.submitted[-1].entries
        self.assertEqual((entry.id, entry.mask), (red.id, 1 << 1 | 1 << 4))
        now = self.scene.get(tessera.Material, "red")
        self.assertEqual((now.roughness, now.base_color, now.metallic), (0.25, (0.5, 0.0, 0.0, 1.0), 0.0))
        self.assertEqual(red.roughness, 1.0)  # a value stays as it was read

    def test_raising_block_sends_nothing(self):
        with self.assertRaises(RuntimeError):
            with self.session.transaction() as edit:
                edit.create("light", name="lamp")
                raise RuntimeError
        with self.assertRaisesRegex(tessera.InvalidInput, "material.base_color: expected 4 numbers"):
            with self.session.transaction() as edit:
                edit.create("material", name="red", base_color=(1, 0))
        self.assertEqual(self.master.submitted, [])

    def test_a_refused_edit_raises_the_problems(self):
        self.create_red()
        self.master.refuse_edits = True
        with self.assertRaises(tessera.Refused) as caught:
            with self.session.transaction() as edit:
                edit.set("materials/red", roughness=0.5)
        self.assertEqual(caught.exception.problems, ("material 'red' is locked by anna",))
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 1.0)

    def test_a_mesh_is_served_to_the_master(self):
        with self.session.transaction() as edit:
            red = edit.create("material", name="red")
            edit.create("geometry", name="floor", material=red, indices=[(0, 1, 2)],
                        positions=array("f", [0, 0, 0, 1, 0, 0, 0, 0, 1]))
        floor = self.scene.get(tessera.Geometry, "floor")
        self.assertEqual(floor.material, red.id)
        self.assertEqual(self.scene.bytes_of(floor.indices), struct.pack("<3I", 0, 1, 2))
        self.assertEqual(list(tessera.floats(self.scene.bytes_of(floor.positions))), [0, 0, 0, 1, 0, 0, 0, 0, 1])
        self.assertIn(floor.id, self.scene.root.children)

    def test_a_large_mesh_and_a_large_edit_go_in_chunks(self):
        data = bytes(range(256)) * (12 * 1024)  # 3 MiB
        with self.session.transaction() as edit:
            edit.create("geometry", name="big", indices=[0, 1, 2], positions=data)
            for i in range(2000):
                edit.create("material", name=f"m{i}")
        self.assertEqual(self.scene.bytes_of(self.scene.get(tessera.Geometry, "big").positions), data)
        self.assertEqual(len(self.scene.all(tessera.Material)), 2000)
        self.assertIn("submit_edit_by_blob", self.master.received)

    def test_scene_as_blob(self):
        self.create_red()
        self.master.scene_by_blob = True
        with connect(self.master) as other:
            self.assertEqual(other.join("room").get(tessera.Material, "red").base_color, (1.0, 0.0, 0.0, 1.0))

    def test_edit_groups_undo_and_redo(self):
        self.create_red()
        drag = self.session.new_edit_group()
        for value in (0.1, 0.2):
            with self.session.transaction(edit_group=drag) as edit:
                edit.set("materials/red", roughness=value)
        self.assertIsNotNone(edit.committed)
        self.assertEqual([e.edit_group for e in self.master.submitted], [0, drag, drag])
        self.assertEqual(self.session.undo().notes, ("left as it is",))
        self.session.undo(3)
        self.session.redo()
        self.assertEqual([e.undo for e in self.master.submitted[-3:]], [2**64 - 1, 3, 2**64 - 2])
        self.assertTrue(all(e.submitted_at > 0 for e in self.master.submitted))

    def test_a_drag_reads_nothing(self):
        red = self.create_red()
        reads = self.master.received.count("read_scene")
        for step in range(20):
            with self.session.transaction(edit_group=1) as edit:
                edit.set(red, roughness=step / 20)
                edit.create("material")
        self.assertEqual(self.master.received.count("read_scene"), reads)

    def test_the_mirror_follows_others(self):
        self.create_red()
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 1.0)
        with connect(self.master) as other:
            other.join("room")
            with other.transaction() as edit:
                edit.set("materials/red", roughness=0.5)
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 1.0)
        self.scene.refresh()
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 0.5)

    def test_other_members(self):
        red = self.create_red()
        self.session.lock([red])
        self.session.unlock([red])
        self.session.set_presence("paints", [red], seconds=2.0)
        self.wait_for(lambda: "set_presence" in self.master.received)
        self.assertEqual(self.master.presence.time_to_live, 2_000_000_000)
        self.assertEqual([p.name for p in self.session.members().members], ["test"])
        self.assertEqual(self.session.history(5)[0].time, 1.5)
        self.assertEqual({f: w.name for f, w in self.session.writers(red).items()}, {"base_color": "anna"})
        self.session.close_scene()
        with self.assertRaises(tessera.InvalidInput):
            self.session.members()


class Breaks(WithMaster):
    def test_rejoins_with_the_same_key(self):
        red = self.create_red()
        self.session.lock([red])
        view = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        key = self.master.members[1].key
        self.master.forget_sessions()
        with self.session.transaction() as edit:
            edit.set("materials/red", roughness=0.5)
        self.wait_for(lambda: 2 in self.master.members and self.master.members[2].key == key)
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 0.5)
        self.wait_for(lambda: self.master.received.count("lock_objects") == 2)
        self.assertEqual(view.wait(samples=1).version, self.scene.version)
        with self.session.transaction() as edit:
            self.assertEqual(edit.create("light").id, red.id + 1)  # the old ids go on

    def test_master_restarted_with_its_journal(self):
        self.create_red()
        self.master.restart()
        with self.session.transaction() as edit:
            edit.set("materials/red", roughness=0.5)
        self.assertEqual(self.scene.version[0], 8)
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 0.5)
        self.assertEqual([e.sequence for e in self.master.submitted], [1, 2])

    def test_lost_accepted_edits_are_an_error(self):
        self.create_red()
        self.master.restart(keep_journal=False)
        with self.assertRaisesRegex(tessera.Unavailable, "lost edits"):
            with self.session.transaction() as edit:
                edit.create("light")

    def test_edit_with_lost_answer_is_applied_once(self):
        self.create_red()
        self.master.ignores_edits = True
        failures = []

        def change():
            try:
                with self.session.transaction() as edit:
                    edit.set("materials/red", roughness=0.5)
            except tessera.Error as error:
                failures.append(error)

        thread = threading.Thread(target=change)
        thread.start()
        self.wait_for(lambda: self.master.received.count("submit_edit") == 2)
        self.master.ignores_edits = False
        self.master.forget_sessions()
        thread.join(10)
        self.assertFalse(thread.is_alive())
        self.assertEqual(failures, [])
        self.assertEqual([e.sequence for e in self.master.submitted], [1, 2])
        self.assertEqual(self.scene.get(tessera.Material, "red").roughness, 0.5)

    def test_timeout_reconnects_with_new_sockets(self):
        self.master.is_mute = True
        time.sleep(6 * self.master.interval)
        self.master.is_mute = False
        self.assertEqual(self.session.status().software, "scripted")
        self.assertGreaterEqual(self.master.received.count("hello"), 2)

    def test_goodbye_reason_is_reported(self):
        with ScriptedMaster() as master, connect(master, lost_limit=0.5) as session:
            session.join("room")
            master.stop(goodbye=True)
            with self.assertRaisesRegex(tessera.Unavailable, "the master left: service ends"):
                session.members()
            master.start()

    def test_malformed_bytes_are_ignored(self):
        source = random.Random(5)
        view = self.session.open_view(self.POSE, size=(8, 4), spp=1 << 40)
        view.wait(samples=1)
        member = self.master.members[1]
        frame = bulk.encode(bulk.FrameHeader(1, 1, 7, 1, 1, 1, 8, 4, 3, 2, 10, 0, 0, 0, 0, 0, 0, 1, 1, 1, bytes(32)))
        chunk = bulk.encode(bulk.PictureChunk(2, 10, 0, bytes(5)))
        notice = control_pb2.Control(notice=control_pb2.Notice(text=b"text")).SerializeToString()
        beat = control_pb2.Control(heartbeat=control_pb2.Heartbeat(sent_at=5)).SerializeToString()
        done = threading.Event()

        def flood():
            for i in range(3000):
                valid = (frame, chunk) if i % 2 else (notice, beat)
                noise = bytearray(source.choice((*valid, source.randbytes(source.randrange(1, 64)))))
                noise[source.randrange(len(noise))] ^= 1 << source.randrange(8)
                self.master.say_raw(i % 2, member.bulk if i % 2 else member.control, bytes(noise))
            done.set()

        self.master.post(flood)
        self.assertTrue(done.wait(10))
        self.wait_for(lambda: self.session.connection.link.malformed > 500)
        time.sleep(4 * self.master.interval)
        self.create_red()
        self.assertEqual(self.scene["materials/red"].name, "red")
        self.assertEqual(view.wait(samples=1).version, self.scene.version)

    def test_invalid_change_list_requests_a_snapshot(self):
        self.create_red()
        self.scene.refresh()
        self.master.number += 1
        self.master.lists.append((self.master.number, [scene_pb2.Entry(id=99, action=scene_pb2.Entry.REMOVE)]))
        self.scene.refresh()
        self.assertEqual(self.scene["materials/red"].name, "red")
        self.assertEqual(self.scene.version, (7, self.master.number))


if __name__ == "__main__":
    unittest.main()
