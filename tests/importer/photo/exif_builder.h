// Makes EXIF data for tests.

#pragma once

#include <cstdlib>
#include <string>

#include <libexif/exif-data.h>

namespace velamap {

class ExifBuilder {
 public:
  ExifBuilder() {
    exif_data_set_option(data_, EXIF_DATA_OPTION_FOLLOW_SPECIFICATION);
    exif_data_set_byte_order(data_, EXIF_BYTE_ORDER_INTEL);
  }
  ~ExifBuilder() { exif_data_unref(data_); }
  ExifBuilder(const ExifBuilder&) = delete;
  ExifBuilder& operator=(const ExifBuilder&) = delete;

  void SetShort(ExifIfd directory, ExifTag tag, int value) {
    exif_set_short(New(directory, tag, EXIF_FORMAT_SHORT, 2)->data, EXIF_BYTE_ORDER_INTEL,
                   static_cast<ExifShort>(value));
  }
  void SetLong(ExifIfd directory, ExifTag tag, int value) {
    exif_set_long(New(directory, tag, EXIF_FORMAT_LONG, 4)->data, EXIF_BYTE_ORDER_INTEL,
                  static_cast<ExifLong>(value));
  }
  void SetRational(ExifIfd directory, ExifTag tag, unsigned numerator, unsigned denominator) {
    exif_set_rational(New(directory, tag, EXIF_FORMAT_RATIONAL, 8)->data, EXIF_BYTE_ORDER_INTEL,
                      {numerator, denominator});
  }

  std::string Data() const {  // from "Exif\0\0" on
    unsigned char* bytes = nullptr;
    unsigned int size = 0;
    exif_data_save_data(data_, &bytes, &size);
    const std::string data(reinterpret_cast<const char*>(bytes), size);
    std::free(bytes);
    return data;
  }

  // The APP1 segment, which belongs directly after the SOI marker (two bytes) of a JPEG file.
  std::string Segment() const {
    const std::string data = Data();
    const std::size_t length = data.size() + 2;
    return std::string{'\xFF', '\xE1', static_cast<char>(length >> 8),
                       static_cast<char>(length & 0xFF)} +
           data;
  }

 private:
  ExifEntry* New(ExifIfd directory, ExifTag tag, ExifFormat format, unsigned size) {
    ExifEntry* entry = exif_entry_new();
    exif_content_add_entry(data_->ifd[directory], entry);
    exif_entry_initialize(entry, tag);
    entry->tag = tag;
    entry->format = format;
    entry->components = 1;
    if (entry->data == nullptr || entry->size < size) {
      entry->data = static_cast<unsigned char*>(std::realloc(entry->data, size));
    }
    entry->size = size;
    exif_entry_unref(entry);
    return entry;
  }

  ExifData* data_ = exif_data_new();
};

}  // namespace velamap
