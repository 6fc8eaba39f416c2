// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/state/hdf5.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>
#include <type_traits>

#include <fmt/format.h>
#include <hdf5.h>

namespace pneuma::pipeline::state::hdf5 {

static_assert(std::is_same_v<hid_t, std::int64_t>);

Handle::~Handle() {
  if (id_ >= 0) close_(id_);
}

namespace {

herr_t keep_innermost(unsigned number, const H5E_error2_t* error, void* text) {
  if (number == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

[[noreturn]] void fail(const std::string& where) {
  std::string reason = "no reason given";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &reason);
  throw Failure(fmt::format("{}: {}", where, reason));
}

// Results of libhdf5 are negative on failure.
template <class Result>
Result checked(Result result, const std::string& where) {
  if (result < 0) fail(where);
  return result;
}

Handle own(hid_t id, Handle::Close close, const std::string& where) {
  return {checked(id, where), close};
}

template <class T>
hid_t type_of() {
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  return H5T_STD_U8LE;
}

// Padded with NUL. VTKHDF wants ASCII for its type, so plain ASCII texts are marked as such.
Handle text_type(std::size_t size, bool ascii, const std::string& where) {
  Handle type = own(H5Tcopy(H5T_C_S1), H5Tclose, where);
  checked(H5Tset_size(type.id(), std::max<std::size_t>(size, 1)), where);
  checked(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), where);
  checked(H5Tset_cset(type.id(), ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8), where);
  return type;
}

bool is_ascii(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 128; });
}

Handle array_space(const Shape& shape, const std::string& where) {
  const std::vector<hsize_t> sizes(shape.begin(), shape.end());
  return own(H5Screate_simple(static_cast<int>(sizes.size()), sizes.data(), nullptr), H5Sclose, where);
}

void write_attribute(hid_t object, const std::string& name, const Handle& type, const Handle& space, const void* data,
                     const std::string& where) {
  const Handle attribute = own(H5Acreate2(object, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                               H5Aclose, where + "@" + name);
  checked(H5Awrite(attribute.id(), type.id(), data), where);
}

void write_attribute(hid_t object, const std::string& name, const std::string& text, const std::string& where) {
  const Handle type = text_type(text.size(), is_ascii(text), where);
  const Handle space = own(H5Screate(H5S_SCALAR), H5Sclose, where);
  write_attribute(object, name, type, space, text.c_str(), where);
}

std::string read_attribute(hid_t object, const std::string& name, const std::string& where) {
  constexpr std::size_t largest = 1 << 16; // a limit of the format
  const Handle attribute = own(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose, where);
  const Handle type = own(H5Aget_type(attribute.id()), H5Tclose, where);
  const Handle space = own(H5Aget_space(attribute.id()), H5Sclose, where);
  const std::size_t size = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0 || size > largest ||
      H5Sget_simple_extent_npoints(space.id()) != 1) {
    throw Failure(where + ": a text of fixed length is expected");
  }
  std::string text(size, '\0');
  checked(H5Aread(attribute.id(), type.id(), text.data()), where);
  return text.substr(0, text.find_last_not_of('\0') + 1);
}

void write_dataset(hid_t group, const std::string& name, hid_t type, const Shape& shape, const void* data,
                   const std::string& unit, const std::string& where) {
  const Handle space = array_space(shape, where);
  const Handle creation = own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, where);
  checked(H5Pset_obj_track_times(creation.id(), false), where); // equal states, equal bytes
  const Handle dataset =
      own(H5Dcreate2(group, name.c_str(), type, space.id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Dclose, where);
  if (std::find(shape.begin(), shape.end(), 0U) == shape.end()) {
    checked(H5Dwrite(dataset.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), where);
  }
  write_attribute(dataset.id(), "unit", unit, where);
}

// A link to another file or a soft link may lead anywhere.
void require_own(hid_t group, const std::string& name, const std::string& where) {
  if (H5Lexists(group, name.c_str(), H5P_DEFAULT) <= 0) throw Failure(where + ": missing");
  H5L_info_t link{};
  checked(H5Lget_info(group, name.c_str(), &link, H5P_DEFAULT), where);
  if (link.type != H5L_TYPE_HARD) throw Failure(where + ": is a link to somewhere else");
}

// libhdf5 keeps a file in memory that these callbacks give it: the one text that `text` points to, so that nothing is
// copied when reading, and the finished file is there when writing. (H5Fget_file_image would be the direct way, but it
// leaves a wrong checksum in the superblock: HDF5 issue 1915.)
void* provide(std::size_t size, H5FD_file_image_op_t /*operation*/, void* text) {
  auto& bytes = *static_cast<std::string*>(text);
  try {
    bytes.resize(size);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
  return bytes.data();
}

void* regrow(void* /*old*/, std::size_t size, H5FD_file_image_op_t operation, void* text) {
  return provide(size, operation, text);
}

void* copy(void* to, const void* from, std::size_t size, H5FD_file_image_op_t /*operation*/, void* /*text*/) {
  return to == from ? to : std::memmove(to, from, size);
}

herr_t release(void* /*memory*/, H5FD_file_image_op_t /*operation*/, void* /*text*/) {
  return 0;
}

void* same_text(void* text) {
  return text;
}

herr_t keep_text(void* /*text*/) {
  return 0;
}

// Failures are thrown by `fail`, not printed. The newest features that VTK 9.1 reads: with them the metadata has
// checksums.
Handle access_to(std::string& bytes) {
  constexpr std::size_t growth = 1; // byte: the file ends where its content ends
  checked(H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr), "file");
  Handle access = own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "file");
  checked(H5Pset_fapl_core(access.id(), growth, false), "file");
  checked(H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V110), "file");
  H5FD_file_image_callbacks_t callbacks = {provide, copy, regrow, release, same_text, keep_text, &bytes};
  checked(H5Pset_file_image_callbacks(access.id(), &callbacks), "file");
  return access;
}

// libhdf5 looks for a file of the name even if the content is given, and takes equal names for the same file.
std::string name_of_no_file() {
  static std::atomic<unsigned> number{0};
  return fmt::format("/dev/null/state-{}", number++);
}

// Closing gives space back to the file system, which memory does not notice: where the file ends is told by its
// superblock of version 2 (HDF5 file format specification 3.0, II.A).
std::uint64_t end_of_file(const std::string& bytes) {
  constexpr std::size_t place = 28;
  std::uint64_t end = 0;
  if (bytes.size() >= place + sizeof end) std::memcpy(&end, bytes.data() + place, sizeof end);
  if (end == 0 || end > bytes.size()) throw Failure("file: its superblock is not the one expected");
  return end;
}

Handle open_image(const std::string& bytes) {
  auto& image = const_cast<std::string&>(bytes); // opened for reading only
  const Handle access = access_to(image);
  checked(H5Pset_file_image(access.id(), image.data(), image.size()), "file");
  return own(H5Fopen(name_of_no_file().c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "file");
}

} // namespace

Group Group::create(const std::string& name) const {
  const Handle creation = own(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, where(name));
  checked(H5Pset_obj_track_times(creation.id(), false), where(name));
  return {own(H5Gcreate2(handle_.id(), name.c_str(), H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose, where(name)),
          where(name) + "/", limit_};
}

Group Group::open(const std::string& name) const {
  require_own(handle_.id(), name, where(name));
  return {own(H5Gopen2(handle_.id(), name.c_str(), H5P_DEFAULT), H5Gclose, where(name)), where(name) + "/", limit_};
}

template <class T>
void Group::write(const std::string& name, std::span<const T> values, const Shape& shape,
                  const std::string& unit) const {
  std::uint64_t count = 1;
  for (const std::uint64_t size : shape) count *= size;
  if (count != values.size()) throw Failure(where(name) + ": the shape does not fit the number of values");
  write_dataset(handle_.id(), name, type_of<T>(), shape, values.data(), unit, where(name));
}

void Group::write(const std::string& name, const std::vector<std::string>& texts) const {
  std::size_t longest = 1;
  bool ascii = true;
  for (const std::string& text : texts) {
    if (text.find('\0') != std::string::npos)
      throw std::invalid_argument(where(name) + ": a text with a NUL cannot be stored");
    longest = std::max(longest, text.size());
    ascii = ascii && is_ascii(text);
  }
  std::string table(longest * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(table.data() + i * longest, longest);
  const Handle type = text_type(longest, ascii, where(name));
  write_dataset(handle_.id(), name, type.id(), {texts.size()}, table.data(), "1", where(name));
}

void Group::set_attribute(const std::string& name, const std::string& text) const {
  write_attribute(handle_.id(), name, text, where(name));
}

void Group::set_attribute(const std::string& name, const std::vector<std::int64_t>& numbers) const {
  const Handle type = own(H5Tcopy(H5T_STD_I64LE), H5Tclose, where(name));
  write_attribute(handle_.id(), name, type, array_space({numbers.size()}, where(name)), numbers.data(), where(name));
}

Handle Group::open_dataset(const std::string& name) const {
  require_own(handle_.id(), name, where(name));
  Handle dataset = own(H5Dopen2(handle_.id(), name.c_str(), H5P_DEFAULT), H5Dclose, where(name));
  const Handle creation = own(H5Dget_create_plist(dataset.id()), H5Pclose, where(name));
  if (H5Pget_layout(creation.id()) != H5D_CONTIGUOUS || H5Pget_external_count(creation.id()) != 0) {
    throw Failure(where(name) + ": is stored in another way than a state's arrays are");
  }
  return dataset;
}

Shape Group::shape(const Handle& dataset, const std::string& name, std::uint64_t size, const Shape& expected) const {
  const Handle space = own(H5Dget_space(dataset.id()), H5Sclose, where(name));
  const int rank = checked(H5Sget_simple_extent_ndims(space.id()), where(name));
  if (rank != static_cast<int>(expected.size())) {
    throw Failure(fmt::format("{}: has {} dimensions instead of {}", where(name), rank, expected.size()));
  }
  std::vector<hsize_t> sizes(expected.size());
  checked(H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr), where(name));
  bool empty = false;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (expected[i] != any && sizes[i] != expected[i]) {
      throw Failure(fmt::format("{}: dimension {} is {} instead of {}", where(name), i, sizes[i], expected[i]));
    }
    empty = empty || sizes[i] == 0;
  }
  // an absurd length must not become an allocation
  std::uint64_t room = limit_ / size;
  for (const hsize_t n : sizes) {
    if (empty) break;
    if (n > room) throw Failure(where(name) + ": claims more values than the file has room for");
    room /= n;
  }
  return {sizes.begin(), sizes.end()};
}

template <class T>
std::vector<T> Group::read(const std::string& name, const Shape& expected) const {
  const Handle dataset = open_dataset(name);
  const Handle type = own(H5Dget_type(dataset.id()), H5Tclose, where(name));
  if (H5Tequal(type.id(), type_of<T>()) <= 0) throw Failure(where(name) + ": values are of another type than expected");
  std::uint64_t count = 1;
  for (const std::uint64_t size : shape(dataset, name, sizeof(T), expected)) count *= size;
  std::vector<T> values(count);
  if (count > 0) checked(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), where(name));
  return values;
}

std::vector<std::string> Group::read_texts(const std::string& name, std::uint64_t expected) const {
  const Handle dataset = open_dataset(name);
  const Handle type = own(H5Dget_type(dataset.id()), H5Tclose, where(name));
  const std::size_t size = H5Tget_size(type.id());
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0 || size == 0) {
    throw Failure(where(name) + ": texts of fixed length are expected");
  }
  const std::uint64_t count = shape(dataset, name, size, {expected})[0];
  std::string table(size * count, '\0');
  if (count > 0) checked(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, table.data()), where(name));
  std::vector<std::string> texts(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::string_view text(table.data() + i * size, size);
    texts[i] = text.substr(0, text.find_last_not_of('\0') + 1);
  }
  return texts;
}

std::string Group::unit(const std::string& dataset) const {
  return read_attribute(open_dataset(dataset).id(), "unit", where(dataset) + "@unit");
}

std::string Group::text_attribute(const std::string& name) const {
  return read_attribute(handle_.id(), name, path_ + "@" + name);
}

std::vector<std::int64_t> Group::number_attribute(const std::string& name) const {
  constexpr hssize_t most = 16;
  const std::string place = path_ + "@" + name;
  const Handle attribute = own(H5Aopen(handle_.id(), name.c_str(), H5P_DEFAULT), H5Aclose, place);
  const Handle type = own(H5Aget_type(attribute.id()), H5Tclose, place);
  const Handle space = own(H5Aget_space(attribute.id()), H5Sclose, place);
  const hssize_t count = checked(H5Sget_simple_extent_npoints(space.id()), place);
  if (count > most || H5Tequal(type.id(), H5T_STD_I64LE) <= 0) throw Failure(place + ": whole numbers are expected");
  std::vector<std::int64_t> numbers(static_cast<std::size_t>(count));
  checked(H5Aread(attribute.id(), type.id(), numbers.data()), place);
  return numbers;
}

template void Group::write(const std::string&, std::span<const double>, const Shape&, const std::string&) const;
template void Group::write(const std::string&, std::span<const std::int32_t>, const Shape&, const std::string&) const;
template void Group::write(const std::string&, std::span<const std::int64_t>, const Shape&, const std::string&) const;
template void Group::write(const std::string&, std::span<const std::uint8_t>, const Shape&, const std::string&) const;
template std::vector<double> Group::read(const std::string&, const Shape&) const;
template std::vector<std::int32_t> Group::read(const std::string&, const Shape&) const;
template std::vector<std::int64_t> Group::read(const std::string&, const Shape&) const;
template std::vector<std::uint8_t> Group::read(const std::string&, const Shape&) const;

File::File(const std::string& bytes) : handle_(open_image(bytes)), limit_(bytes.size()) {}

Group File::root() const {
  return {own(H5Gopen2(handle_.id(), "/", H5P_DEFAULT), H5Gclose, "/"), "/", limit_};
}

std::string new_file(const std::function<void(const Group& root)>& fill) {
  std::string bytes;
  const Handle access = access_to(bytes);
  const Handle creation = own(H5Pcreate(H5P_FILE_CREATE), H5Pclose, "file");
  checked(H5Pset_obj_track_times(creation.id(), false), "file");
  {
    const Handle file =
        own(H5Fcreate(name_of_no_file().c_str(), H5F_ACC_TRUNC, creation.id(), access.id()), H5Fclose, "file");
    fill({own(H5Gopen2(file.id(), "/", H5P_DEFAULT), H5Gclose, "/"), "/", any});
    checked(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "file");
  }
  bytes.resize(end_of_file(bytes));
  return bytes;
}

} // namespace pneuma::pipeline::state::hdf5
