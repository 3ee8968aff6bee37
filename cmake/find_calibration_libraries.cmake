# pickcell_calibration_libraries: the five libraries of OpenCV that calibration needs, by name (OpenCV's own CMake files lie in
# libopencv-dev, which pulls in hundreds of megabytes more), and Ceres.
find_path(OPENCV_INCLUDE opencv2/imgproc.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(pickcell_calibration_libraries INTERFACE)
foreach(name aruco calib3d features2d imgproc core)
  string(TOUPPER OPENCV_${name} variable)
  find_library(${variable} opencv_${name} REQUIRED)
  target_link_libraries(pickcell_calibration_libraries INTERFACE ${${variable}})
endforeach()
target_include_directories(pickcell_calibration_libraries SYSTEM INTERFACE ${OPENCV_INCLUDE})
find_package(Ceres REQUIRED)
target_link_libraries(pickcell_calibration_libraries INTERFACE Ceres::ceres)
