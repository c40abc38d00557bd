#pragma once

#include <string>
#include <string_view>

#include "core/messages.hpp"
#include "io/files/text_file.hpp"

/// The rows of `objects_online.csv` and `objects_final.csv` (docs/formats.md).
namespace motorcade {

/// The columns that every header begins with. Runs of earlier versions have no others.
inline constexpr std::string_view kObjectsHeaderStart =
    "frame,track_id,state,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz,vx,vy,vz,speed_sigma_mps,points,left,top,right,"
    "bottom";
inline constexpr std::string_view kObjectsHeader =
    "frame,track_id,state,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz,vx,vy,vz,speed_sigma_mps,points,left,top,right,"
    "bottom,box_x_m,box_y_m,box_z_m,length_m,width_m,height_m,box_x_sigma_m,box_y_sigma_m,box_z_sigma_m,length_sigma_m,"
    "width_sigma_m,height_sigma_m,kind,kind_probability,heading_rad,heading_sigma_rad,yaw_rate_radps,"
    "yaw_rate_sigma_radps,center_x_m,center_y_m,center_z_m,center_x_sigma_m,center_y_sigma_m,center_z_sigma_m,age_s,"
    "existence_probability,acceleration_mps2,acceleration_sigma_mps2,yaw_acceleration_radps2,"
    "yaw_acceleration_sigma_radps2";

std::string_view stateName(ObjectState state);
std::string_view kindName(ObjectKind kind);

std::string objectLine(FrameId frame, const ObjectEstimate& object);
/// Reads all columns but the frame, which is read already. Columns that follow from others are passed over. Fails with
/// the column's name.
ObjectEstimate readObject(FieldReader& fields);

}  // namespace motorcade
