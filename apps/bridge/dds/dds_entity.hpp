#pragma once

#include <memory>
#include <string>

#include <dds/dds.h>
#include <fmt/format.h>

#include "io/files/errors.hpp"

/// Handles of Cyclone DDS that end with their scope.
namespace motorcade {

/// A handle that also ends the entities that were made in it.
class DdsEntity {
 public:
  /// Throws OutputError if DDS refused to create it.
  DdsEntity(dds_entity_t entity, const std::string& what) : entity_(entity) {
    if (entity < 0) throw OutputError(fmt::format("{}: DDS says: {}", what, dds_strretcode(entity)));
  }
  ~DdsEntity() { dds_delete(entity_); }
  DdsEntity(const DdsEntity&) = delete;
  DdsEntity& operator=(const DdsEntity&) = delete;
  dds_entity_t get() const { return entity_; }

 private:
  dds_entity_t entity_;
};

struct DeleteDdsQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using DdsQos = std::unique_ptr<dds_qos_t, DeleteDdsQos>;

}  // namespace motorcade
