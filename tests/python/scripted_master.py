"""A fake master: ROUTER sockets, one scene, frames on demand. Tests look into it and make it
forget, fall silent or lie."""

import struct
import threading
import time

import zmq
from ports import free_port

from tessera import blobs, bulk
from tessera.film import FilmTile, plane_count
from tessera.proto import common_pb2, control_pb2, scene_pb2, session_pb2, status_pb2, view_pb2

PNG = b"\x89PNG\r\n\x1a\n" + b"picture" * 4


class Member:
    def __init__(self, number, token):
        self.number, self.token = number, token
        self.control = self.bulk = None
        self.waiting = []  # bulk messages, until the member's bulk link has joined
        self.name, self.key = b"", 0
        self.frame, self.taken = {}, {}


class ScriptedMaster:
    """Runs on a thread of its own between `start` and `stop`. What tests change is read on every message."""

    def __init__(self, port=None, interval=0.05):
        self.port = port or free_port()
        self.endpoint = f"tcp://127.0.0.1:{self.port}"
        self.interval = interval
        self.epoch, self.number = 7, 1
        self.objects = {1: scene_pb2.Object(root=scene_pb2.Root(render_origin=[0, 0, 0]))}
        self.lists = []  # (to, entries)
        self.members, self.by_control = {}, {}
        self.editors = {}  # key -> [first id, last sequence, last reply]
        self.blobs, self.wanted = {}, {}
        self.received = []  # names of messages, in order
        self.heartbeats = []
        self.refuse_edits = self.refuse_hello = self.is_mute = self.ignores_edits = False
        self.scene_by_blob = self.withholds_frames = False
        self.views, self.ended = {}, set()
        self.failed_tiles = []  # of the next summaries
        self.submitted = []
        self.heads, self.adjustments = [], []
        self._next = 1
        self._posted = []
        self._stop = threading.Event()
        self._thread = None

    def __enter__(self):
        return self.start()

    def __exit__(self, *_):
        self.stop()

    def start(self):
        self._stop.clear()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        return self

    def stop(self, goodbye=False):
        if goodbye:
            self.post(lambda: [self._say(m.control, "goodbye", reason=b"service ends") for m in self.members.values()])
            time.sleep(0.05)
        self._stop.set()
        self._thread.join()

    def forget_sessions(self):
        """As after a restart of the master, on the same sockets."""
        self.post(lambda: (self.members.clear(), self.by_control.clear()))

    def restart(self, keep_journal=True):
        """Another process: new epoch, new sockets, no sessions."""
        self.stop()
        self.members, self.by_control, self.views = {}, {}, {}
        self.epoch += 1
        self.lists = []
        if not keep_journal:
            self.editors = {}
            self.objects = {1: self.objects[1]}
        self.start()

    def post(self, task):
        """Done by the master's thread before its next message."""
        self._posted.append(task)

    def wait_for(self, is_there, seconds=10.0):
        end = time.monotonic() + seconds
        while not is_there():
            assert time.monotonic() < end, "the scripted master waits in vain"
            time.sleep(0.005)

    def _run(self):
        context = zmq.Context()
        self._sockets = [context.socket(zmq.ROUTER), context.socket(zmq.ROUTER)]
        for link, link_socket in enumerate(self._sockets):
            link_socket.linger = 200
            self._bind(link_socket, self.port + link)
        poller = zmq.Poller()
        for link_socket in self._sockets:
            poller.register(link_socket, zmq.POLLIN)
        last_beat = 0.0
        while not self._stop.is_set():
            ready = dict(poller.poll(5))
            while self._posted:
                self._posted.pop(0)()
            for link, link_socket in enumerate(self._sockets):
                if link_socket in ready:
                    peer, data = link_socket.recv_multipart()
                    if not self.is_mute:
                        (self._control if link == 0 else self._bulk)(peer, data)
            if time.monotonic() - last_beat > self.interval and not self.is_mute:
                last_beat = time.monotonic()
                for member in self.members.values():
                    self._say(member.control, "heartbeat", sent_at=time.monotonic_ns())
        for link_socket in self._sockets:
            link_socket.close()
        context.term()

    @staticmethod
    def _bind(link_socket, port):
        for _ in range(200):
            try:
                return link_socket.bind(f"tcp://127.0.0.1:{port}")
            except zmq.ZMQError:
                time.sleep(0.02)
        raise OSError("the port stays taken")

    def _say(self, peer, kind, **fields):
        message = control_pb2.Control()
        target = getattr(message, kind)
        target.SetInParent()
        for name, value in fields.items():
            if isinstance(value, (list, tuple)):
                getattr(target, name).extend(value)
            elif hasattr(value, "DESCRIPTOR"):
                getattr(target, name).CopyFrom(value)
            else:
                setattr(target, name, value)
        self.say_raw(0, peer, message.SerializeToString())

    def say_raw(self, link, peer, data):
        self._sockets[link].send_multipart([peer, data])

    def _control(self, peer, data):
        message = control_pb2.Control.FromString(data)
        kind = message.WhichOneof("message")
        self.received.append(kind)
        content = getattr(message, kind)
        if kind == "hello":
            return self._hello(peer, content)
        member = self.by_control.get(peer)
        if member is None:
            return None if kind == "goodbye" else self._say(peer, "unknown")
        return getattr(self, "_on_" + kind)(member, content)

    def _hello(self, peer, hello):
        if self.refuse_hello:
            return self._say(peer, "refusal", reason=b"too many sessions")
        member = next((m for m in self.members.values() if m.token == hello.resume_token), None)
        if member is None:
            member = Member(self._next, 1000 + self._next)
            self._next += 1
            self.members[member.number] = member
        self.by_control = {p: m for p, m in self.by_control.items() if m is not member}
        member.control = peer
        self.by_control[peer] = member
        return self._say(peer, "welcome", peer_number=member.number, token=member.token, epoch=self.epoch,
                         heartbeat_interval=int(self.interval * 1e9), missed_heartbeats=3)

    def _version(self, number=None):
        return common_pb2.Version(epoch=self.epoch, number=self.number if number is None else number)

    def _on_heartbeat(self, member, beat):
        self.heartbeats.append((beat.sent_at, beat.echo_sent_at, beat.echo_delay, time.monotonic_ns()))

    def _on_goodbye(self, member, _):
        self.members.pop(member.number, None)
        self.by_control.pop(member.control, None)

    def _on_status_request(self, member, _):
        self._say(member.control, "status_reply", status=status_pb2.ClusterStatus(
            software=b"scripted", version=self._version(), uptime_seconds=1.5))

    def _on_join_scene(self, member, join):
        member.name, member.key = join.name, join.key
        editor = self.editors.setdefault(join.key, [65536 * (len(self.editors) + 1), 0, None])
        self._say(member.control, "scene_joined", version=self._version(), first_id=editor[0], id_count=65536,
                  last_sequence=editor[1], title=b"room", name=join.name)

    def _on_read_scene(self, member, read):
        changes = scene_pb2.ChangeList()
        changes.to.CopyFrom(self._version())
        steps = [entries for to, entries in self.lists if to > read.known.number]
        ids = [entry.id for entries in steps for entry in entries]
        if (read.known.epoch == self.epoch and len(steps) == self.number - read.known.number and
                len(ids) == len(set(ids))):  # a snapshot serves where entries would have to be merged
            getattr(changes, "from").CopyFrom(read.known)
            changes.entries.extend(entry for entries in steps for entry in entries)
        else:
            changes.entries.extend(scene_pb2.Entry(id=i, action=scene_pb2.Entry.CREATE, object=o)
                                   for i, o in self.objects.items())
        if self.scene_by_blob or changes.ByteSize() > 60_000:
            data = changes.SerializeToString()
            name = blobs.digest(data)
            self.blobs[name] = data
            return self._say(member.control, "scene_content", request=read.request,
                             blob=common_pb2.BlobRef(hash=name, byte_size=len(data)))
        return self._say(member.control, "scene_content", request=read.request, list=changes)

    def _on_submit_edit(self, member, submit):
        self._edit(member, submit.edit)

    def _on_submit_edit_by_blob(self, member, submit):
        self._need(member, [submit.blob], lambda: self._edit(
            member, scene_pb2.Edit.FromString(self.blobs[submit.blob.hash])))

    def _edit(self, member, edit):
        if self.ignores_edits:
            return
        self.submitted.append(edit)
        editor = self.editors[member.key]
        if edit.sequence == editor[1]:
            return self._say(member.control, "edit_reply", sequence=edit.sequence, result=editor[2])
        refs = [getattr(e.object.geometry, name) for e in edit.entries if e.object.HasField("geometry")
                for name in ("indices", "positions", "normals", "tangents", "tex_coords", "colors")]
        self._need(member, refs, lambda: self._apply(member, editor, edit))

    def _apply(self, member, editor, edit):
        if self.refuse_edits:
            reply = session_pb2.EditResult(accepted=False, problems=[b"material 'red' is locked by anna"])
        else:
            for entry in edit.entries:
                if entry.action == scene_pb2.Entry.CREATE:
                    self.objects[entry.id] = entry.object
                elif entry.action == scene_pb2.Entry.REMOVE:
                    del self.objects[entry.id]
                else:
                    self._update(entry)
            self.number += 1
            self.lists.append((self.number, list(edit.entries)))
            reply = session_pb2.EditResult(accepted=True, version=self._version(), transaction=edit.sequence,
                                           notes=[b"left as it is"] if edit.undo else [])
        editor[1:] = [edit.sequence, reply]
        self._say(member.control, "edit_reply", sequence=edit.sequence, result=reply)

    def _update(self, entry):
        word = entry.object.WhichOneof("kind")
        source, target = getattr(entry.object, word), getattr(self.objects[entry.id], word)
        for i, field in enumerate(source.DESCRIPTOR.fields):
            if entry.mask >> i & 1:
                target.ClearField(field.name)
                part = type(source)()
                part.CopyFrom(source)
                for other in source.DESCRIPTOR.fields:
                    if other.name != field.name:
                        part.ClearField(other.name)
                target.MergeFrom(part)

    def _need(self, member, refs, then):
        missing = {bytes(r.hash): r.byte_size for r in refs if r.byte_size and bytes(r.hash) not in self.blobs}
        if not missing:
            return then()
        for name in missing:
            self.wanted[name] = [bytearray(), member, refs, then]
            self._send_bulk(member, bulk.BlobRequest(name, 0))
        return None

    def _on_lock_objects(self, member, lock):
        self._done(member, lock)

    def _on_close_scene(self, member, close):
        self._done(member, close)

    def _done(self, member, request, accepted=True, text=b""):
        self._say(member.control, "request_done", request=request.request, accepted=accepted, text=text)

    def _on_move_head(self, member, move):
        if not member.name:
            return self._say(member.control, "refusal", reason=b"this client is in no live scene: join one first")
        self.heads.append(move.head)
        return None

    def _on_adjust_display(self, member, change):
        self.adjustments.append(change.adjustment)
        self._done(member, change, change.adjustment.eye_separation <= 10.0, b"the eye separation is not within 0 and 10 m")

    def _on_set_presence(self, member, presence):
        self.presence = presence

    def _on_read_members(self, member, read):
        self._say(member.control, "members", request=read.request, content=session_pb2.MembersInScene(
            title=b"room", members=[session_pb2.Member(session=m.number, name=m.name, user=b"editor", editor=True)
                                   for m in self.members.values()]))

    def _on_read_history(self, member, read):
        self._say(member.control, "history", request=read.request, transactions=[
            session_pb2.TransactionSummary(number=2, name=b"anna", time=1_500_000_000, text=b"set materials/red")])

    def _on_read_writers(self, member, read):
        self._say(member.control, "writers", request=read.request, fields=[
            session_pb2.FieldWriter(field=1, transaction=2, name=b"anna", time=2_000_000_000),
            session_pb2.FieldWriter(field=99, transaction=2)])

    def _on_request_view(self, member, request):
        known = self.views.get(request.number)
        if request.wanted.stop.spp == 0:
            return self._done(member, request, False, b"a view needs samples")
        changed = known and (known[0].wanted != request.wanted)
        revision = known[1] + changed if known else 1
        self.views[request.number] = (request, revision)
        if request.request:
            self._done(member, request)
        if request.number not in member.frame or request.request == 0:
            member.frame[request.number] = member.frame.get(request.number, 0)
            if request.wanted.frames == 0:
                self.send_frame(member, request.number, 1)
            else:
                self._render(member, request)
        return None

    def _render(self, member, request):
        """The end alone; of a request without an end, once it is asked for."""
        self._say(member.control, "view_progress", number=request.number, progress=view_pb2.Progress(
            phase=2, samples=5, samples_expected=64, rays=9, nodes=1, elapsed=1_500_000_000))
        if request.wanted.stop.spp < 1 << 20:
            self._end(member, request.number, 0, request.wanted.stop.spp)

    def _end(self, member, number, outcome, samples):
        self.ended.add(number)
        self.send_frame(member, number, samples, complete=1)
        self._say(member.control, "view_done", number=number, frame=member.frame[number], summary=view_pb2.ViewSummary(
            outcome=5 if self.failed_tiles else outcome, message=b"", version=self._version(), seconds_render=0.5, rays=7, samples=samples * 32,
            min_samples=samples, max_samples=samples, nodes=[view_pb2.NodeSummary(name=b"n1")],
            failed_tiles=self.failed_tiles))

    def _on_end_view(self, member, end):
        if end.deliver:
            self._end(member, end.number, 2, 3)
        else:
            self.views.pop(end.number, None)

    def _on_frame_taken(self, member, taken):
        member.taken[taken.number] = taken.frame
        if taken.number in self.views and taken.number not in self.ended and not self.withholds_frames:
            samples = 2 ** taken.frame
            spp = self.views[taken.number][0].wanted.stop.spp
            if samples <= spp:
                self.send_frame(member, taken.number, samples)

    def _on_pick(self, member, pick):
        if pick.x == 0:
            return self._say(member.control, "picked", request=pick.request)
        if pick.x == 1:
            return self._say(member.control, "picked", request=pick.request, problem=b"the node is gone")
        return self._say(member.control, "picked", request=pick.request, result=view_pb2.PickResult(
            hit=True, object=65536, position=[1.0, 2.0, 3.0], normal=[0.0, 1.0, 0.0], distance=4.0))

    def send_frame(self, member, number, samples, **changes):
        """The next frame of a view: header, picture in two pieces, film in two tiles."""
        request, revision = self.views[number]
        request = request.wanted
        member.frame[number] += 1
        width, height = request.view.width, request.view.height
        encoding = bulk.ENCODINGS[request.picture]
        picture = PNG if encoding == "png" else b""
        if encoding == "planes":
            picture = struct.pack(f"<{3 * width * height}f", *range(3 * width * height))
        fields = dict(view=number, frame=member.frame[number], epoch=self.epoch, number=self.number, revision=revision,
                      scale=1, width=width, height=height, components=3, encoding=request.picture,
                      picture_bytes=len(picture), film_x=0, film_y=0, film_width=width if request.film else 0,
                      film_height=height if request.film else 0, film_tiles=2 if request.film else 0,
                      complete=int(samples == request.stop.spp), min_samples=samples, max_samples=samples,
                      spp=request.stop.spp, film_hash=bytes(32))
        fields.update(changes)
        frame = fields["frame"]
        messages = [bulk.FrameHeader(**fields)]
        half = len(picture) // 2
        if picture:
            messages += [bulk.PictureChunk(frame, len(picture), 0, picture[:half]),
                         bulk.PictureChunk(frame, len(picture), half, picture[half:])]
        if request.film:
            left = width // 2
            for index, (x, w) in enumerate(((0, left), (left, width - left))):
                planes = plane_count(request.view.channels)
                messages.append(bulk.FrameTile(frame, index, 2, FilmTile(
                    x, 0, w, height, request.view.channels, samples.to_bytes(4, "little") * (w * height),
                    bytes(4 * w * height * planes))))
        for message in messages:
            self._send_bulk(member, message)

    def _send_bulk(self, member, message):
        """The two links join in either order: on a busy machine a request comes before the bulk link."""
        if member.bulk is None:
            member.waiting.append(message)
        else:
            self.say_raw(1, member.bulk, bulk.encode(message))

    def _bulk(self, peer, data):
        message = bulk.decode(data)
        if isinstance(message, bulk.BulkHello):
            for member in self.members.values():
                if member.token == message.token:
                    member.bulk = peer
                    while member.waiting:
                        self._send_bulk(member, member.waiting.pop(0))
        elif isinstance(message, bulk.BlobRequest):
                self.say_raw(1, peer, bulk.encode(blobs.answer(message, self.blobs.get(message.hash))))
        elif isinstance(message, bulk.BlobChunk):
            known = self.wanted.get(message.hash)
            if known is None:
                return
            known[0] += message.data
            if len(known[0]) < message.total:
                return self.say_raw(1, peer, bulk.encode(bulk.BlobRequest(message.hash, len(known[0]))))
            del self.wanted[message.hash]
            self.blobs[message.hash] = bytes(known[0])
            if all(r.byte_size == 0 or bytes(r.hash) in self.blobs for r in known[2]):
                known[3]()
        elif isinstance(message, bulk.BlobAbsent):
            self.received.append("blob_absent")
