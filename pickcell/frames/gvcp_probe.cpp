#include "pickcell/frames/gvcp_probe.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>

namespace pickcell::frames {

namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::uint16_t kDiscoveryId = 0xffff;  // what cameras expect of everybody

sockaddr_in to(std::uint32_t address, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_addr.s_addr = htonl(address);
  out.sin_port = htons(port);
  return out;
}

int open_socket() { return ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, IPPROTO_UDP); }

void send(int socket, std::span<const std::byte> bytes, std::uint32_t address) {
  const sockaddr_in peer = to(address, gvcp::kPort);
  // Nobody there is no failure of ours: the answer stays away.
  (void)::sendto(socket, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&peer), sizeof peer);
}

/// Waits until the time for a datagram; gives its length, 0 when none came. What came already is given even when the
/// time is over.
std::size_t receive(int socket, std::span<std::byte> into, steady_clock::time_point until) {
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(until - steady_clock::now()).count();
    pollfd p{socket, POLLIN, 0};
    if (::poll(&p, 1, static_cast<int>(std::max<decltype(left)>(left, 0))) <= 0) return 0;
    const ssize_t n = ::recv(socket, into.data(), into.size(), 0);
    if (n > 0) return static_cast<std::size_t>(n);
    if (left <= 0) return 0;
  }
}

/// Where a broadcast reaches the neighbours of each interface; the interface itself where it has none (loopback).
struct Neighbourhood {
  std::uint32_t own, all;
};
std::vector<Neighbourhood> neighbourhoods() {
  std::vector<Neighbourhood> out;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return out;
  const auto address = [](const sockaddr* a) {
    return ntohl(reinterpret_cast<const sockaddr_in*>(a)->sin_addr.s_addr);
  };
  for (const ifaddrs* i = list; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET || (i->ifa_flags & IFF_UP) == 0) continue;
    const std::uint32_t own = address(i->ifa_addr);
    const bool broadcasts = (i->ifa_flags & IFF_BROADCAST) != 0 && i->ifa_broadaddr != nullptr;
    out.push_back({own, broadcasts ? address(i->ifa_broadaddr) : own});
  }
  ::freeifaddrs(list);
  return out;
}

}  // namespace

GvcpProbe::GvcpProbe(std::uint32_t address) : address_(address), socket_(open_socket()) {}

GvcpProbe::~GvcpProbe() {
  if (socket_ >= 0) (void)::close(socket_);
}

std::optional<gvcp::RegisterAnswer> GvcpProbe::read(std::uint32_t address, milliseconds timeout) {
  const auto until = steady_clock::now() + timeout;
  id_ = static_cast<std::uint16_t>(id_ % 0xfffe + 1);  // 0 is none
  send(socket_, gvcp::read_register(address, id_), address_);
  std::array<std::byte, 600> datagram{};
  while (const std::size_t n = receive(socket_, datagram, until))
    if (auto answer = gvcp::parse_register(std::span(datagram).first(n), id_)) return answer;
  return std::nullopt;
}

std::optional<gvcp::Identity> GvcpProbe::identify(milliseconds timeout) {
  const auto until = steady_clock::now() + timeout;
  send(socket_, gvcp::discovery(kDiscoveryId), address_);
  std::array<std::byte, 600> datagram{};
  while (const std::size_t n = receive(socket_, datagram, until))
    if (auto answer = gvcp::parse_discovery(std::span(datagram).first(n), kDiscoveryId)) {
      answer->address = address_;  // behind a router, or with an address of its own opinion
      return answer;
    }
  return std::nullopt;
}

std::vector<gvcp::Identity> discover_gige(milliseconds timeout) {
  const auto until = steady_clock::now() + timeout;
  std::vector<int> sockets;
  for (const Neighbourhood& near : neighbourhoods()) {
    const int s = open_socket();
    if (s < 0) continue;
    const int yes = 1;
    (void)::setsockopt(s, SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes);
    const sockaddr_in own = to(near.own, 0);
    (void)::bind(s, reinterpret_cast<const sockaddr*>(&own), sizeof own);
    send(s, gvcp::discovery(kDiscoveryId), near.all);
    if (near.own == near.all || near.own >> 24 == 127) send(s, gvcp::discovery(kDiscoveryId), near.own);
    sockets.push_back(s);
  }
  std::vector<gvcp::Identity> found;
  std::array<std::byte, 600> datagram{};
  for (const int s : sockets) {
    while (const std::size_t n = receive(s, datagram, until)) {
      auto answer = gvcp::parse_discovery(std::span(datagram).first(n), kDiscoveryId);
      if (answer &&
          std::none_of(found.begin(), found.end(), [&](const auto& f) { return f.address == answer->address; }))
        found.push_back(std::move(*answer));
    }
  }
  for (const int s : sockets) (void)::close(s);
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.address < b.address; });
  return found;
}

std::optional<std::uint32_t> resolve(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (host.empty() || ::getaddrinfo(host.c_str(), nullptr, &hints, &found) != 0) return std::nullopt;
  const std::uint32_t address = ntohl(reinterpret_cast<const sockaddr_in*>(found->ai_addr)->sin_addr.s_addr);
  ::freeaddrinfo(found);
  return address;
}

}  // namespace pickcell::frames
