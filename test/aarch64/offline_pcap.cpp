// SPDX-License-Identifier: Apache-2.0
// The part of libpcap's interface with which tools/capture reads files, for a cross build, which
// has no libpcap: captures of this machine's byte order with stamps in nanoseconds, as flight logs
// are, and no others. The layout is that of the public description of the file format
// (draft-ietf-opsawg-pcap).
#include <pcap/pcap.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

struct pcap {
  std::FILE* stream = nullptr;
  int link_type = 0;
  pcap_pkthdr header = {};
  std::vector<uint8_t> bytes;
  char error[PCAP_ERRBUF_SIZE] = {};
};

namespace {

constexpr uint32_t kNanosecondMagic = 0xa1b23c4d;
constexpr uint32_t kMostBytes = 1 << 18;

}  // namespace

extern "C" {

pcap_t* pcap_fopen_offline_with_tstamp_precision(std::FILE* stream, u_int precision, char* error) {
  std::array<uint32_t, 6> header = {};  // magic, versions, two of no use, snapshot, link type
  const bool whole = std::fread(header.data(), sizeof(header), 1, stream) == 1;
  if (!whole || header[0] != kNanosecondMagic || precision != PCAP_TSTAMP_PRECISION_NANO) {
    std::strncpy(error, "no capture of this byte order in nanoseconds", PCAP_ERRBUF_SIZE - 1);
    return nullptr;
  }
  auto* const file = new pcap;
  file->stream = stream;
  file->link_type = static_cast<int>(header[5] & 0xffffu);
  return file;
}

void pcap_close(pcap_t* file) {
  std::fclose(file->stream);
  delete file;
}

int pcap_datalink(pcap_t* file) {
  return file->link_type;
}

const char* pcap_datalink_val_to_name(int /*link_type*/) {
  return nullptr;
}

char* pcap_geterr(pcap_t* file) {
  return file->error;
}

int pcap_next_ex(pcap_t* file, pcap_pkthdr** header, const u_char** data) {
  std::array<uint32_t, 4> record = {};  // seconds, nanoseconds, captured and original length
  const size_t got = std::fread(record.data(), 1, sizeof(record), file->stream);
  if (got == 0) return PCAP_ERROR_BREAK;
  file->bytes.resize(record[2] <= kMostBytes ? record[2] : 0);
  const bool whole = got == sizeof(record) && record[2] <= kMostBytes &&
                     std::fread(file->bytes.data(), 1, record[2], file->stream) == record[2];
  if (!whole) {
    std::strncpy(file->error, "truncated", sizeof(file->error) - 1);
    return PCAP_ERROR;
  }
  file->header.ts = {static_cast<time_t>(record[0]), static_cast<suseconds_t>(record[1])};
  file->header.caplen = record[2];
  file->header.len = record[3];
  *header = &file->header;
  *data = file->bytes.data();
  return 1;
}

}  // extern "C"
