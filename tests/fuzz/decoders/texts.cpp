#include "client/display_file/document.h"
#include "mediator/net/key_file.h"
#include "mediator/program/command_line.h"
#include "tests/fuzz/decoders/decoder.h"

// Configuration files and keys.
namespace tessera::fuzz {

namespace {

void toml(Bytes bytes) {
    accepts([&] { (void)display_file::parse_document(text_of(bytes), "wall.toml"); });
    const std::string path = file_of("tessera.toml", bytes).string();
    accepts([&] { (void)cli::read_config(path); });
}

Seeds toml_seeds() {
    return {
        bytes_of("size = '64x48'\nspp = 16\n[render]\nout = \"a.png\"\nfilter = ['fdf', 'nlm']\n"
                 "quiet = true\nscale = 0.5\n[keys.add]\nrole = 'viewer'\n")};
}

void keys(Bytes bytes) {
    const std::string text(text_of(bytes));
    accepts([&] { (void)net::parse_key("a.public", text); });
    accepts([&] {
        const std::vector<net::AllowedKey> allowed = net::parse_allowed("allowed.keys", text);
        const std::string written = net::allowed_text(allowed);
        require(net::allowed_text(net::parse_allowed("allowed.keys", written)) == written,
                "a list of keys changes when it is written and read");
    });
    accepts([&] {
        const std::string written = net::export_text(net::parse_export("ann.key", text));
        require(net::export_text(net::parse_export("ann.key", written)) == written,
                "an exported key changes when it is written and read");
    });
}

// The pairs of libzmq's documentation.
Seeds keys_seeds() {
    const std::string server = "rq:rM>}U?@Lns47E1%kR.o@n%FcmmsL/@{H8]yf7";
    const std::string client = "Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID";
    const std::string secret = "D:)Q[IlAW!ahhC2ac:9*A}h:p?([4%wOTJ%JR%cs";
    return {bytes_of(server + "\n"), bytes_of("# keys\nann viewer " + client + "\nbob node " + server + "\n"),
            bytes_of("name = \"ann\"\nrole = \"viewer\"\npublic = \"" + client + "\"\nsecret = \"" + secret +
                     "\"\nmaster = \"" + server + "\"\n")};
}

}  // namespace

std::vector<Decoder> text_decoders() {
    return {{"toml", toml, toml_seeds}, {"keys", keys, keys_seeds}};
}

}  // namespace tessera::fuzz
