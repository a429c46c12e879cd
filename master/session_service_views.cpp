// Views that go on with film of their client.
#include "master/session_service.h"
#include "mediator/wire/film_state_codec.h"

namespace tessera::master {

void SessionService::request_view(SessionRecord& session, const wire::RequestView& request, TimePoint now) {
    if (!request.earlier || request.share) return scene_.handle(session, request, now);
    if (session.role == net::Role::Viewer) {
        return outbox_.control(
            session.control, wire::RequestDone{request.request, false,
                                               "a viewer cannot send film to continue: use an editor's key"});
    }
    wire::RequestView wanted = request;
    if (session.continuing) {
        // A client that has lost its link sends its request again, and its view without the number of the request.
        const wire::RequestView& before = *session.continuing;
        const bool is_again =
            before.number == wanted.number && (wanted.request == 0 || wanted.request == before.request);
        if (is_again) {
            wanted.request = before.request;
        } else {
            refuse_view(session, "another view was requested before its film was here");
        }
    }
    session.continuing = std::move(wanted);
    advance(session, now);
}

void SessionService::refuse_view(SessionRecord& session, std::string problem) {
    const wire::RequestView request = *std::exchange(session.continuing, std::nullopt);
    outbox_.control(session.control, wire::RequestDone{request.request, false, std::move(problem)});
}

void SessionService::end_view(SessionRecord& session, const wire::EndView& request, TimePoint now) {
    if (session.continuing && session.continuing->number == request.number)
        return refuse_view(session, "the view was ended before its film was here");
    scene_.views().end(session.id, request, now);
}

void SessionService::advance_view(SessionRecord& session, TimePoint now) {
    if (session.film_is_being_decoded || scene_.is_editing()) return;
    const scene::BlobRef wanted = session.continuing->earlier->film;
    const auto film = std::make_shared<Expected<frame::FilmState>>();
    scene::BlobPtr content;
    try {
        content = blobs_->find(wanted.hash);
        if (!content) return want(session, wanted, "the film of a view");
        if (std::string problem = scene_.memory_problem(content->bytes().size(), "the film of a view");
            !problem.empty())
            throw Error(ErrorCode::Refused, problem);
    } catch (const Error& error) {
        return refuse_view(session, error.what());
    }
    const auto decode = [film, content](SceneAuthority&) {
        try {
            *film = wire::decode_film_state(content->bytes());
        } catch (const std::bad_alloc&) {
            *film = failure(ErrorCode::OutOfMemory, "the master has no memory for it: crop the view");
        }
    };
    session.film_is_being_decoded = true;
    scene_.run(
        {.objects = content->bytes().size()}, decode,
        [this, film, wanted, id = session.id](TimePoint at) {
            film_decoded(id, wanted, std::move(*film), at);
        },
        now);
}

void SessionService::film_decoded(SessionId id, const scene::BlobRef& blob, Expected<frame::FilmState>&& film,
                                  TimePoint now) {
    SessionRecord* session = sessions_.find(id);
    if (session == nullptr) return;  // it has left
    session->film_is_being_decoded = false;
    if (!session->continuing) return;
    if (session->continuing->earlier->film != blob) return advance(*session, now);
    if (!scene_.is_member(id)) return refuse_view(*session, "this session has no open scene: open one first");
    if (!film) return refuse_view(*session, std::string("its film: ") + film.error().what());
    const wire::RequestView request = *std::exchange(session->continuing, std::nullopt);
    scene_.handle(*session, request, now, std::move(*film));
}

}  // namespace tessera::master
