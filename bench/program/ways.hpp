#pragma once
// A way to a picture that takes turns with others, and what its runs gave.
#include <memory>
#include <string>
#include <vector>

#include "whole_pictures.hpp"

namespace raylab::bench {

/// Names what a row was rendered with: what is usual, where a scene has it otherwise too, goes without saying.
std::string name_of(const Row& row);

class Way {
 public:
  explicit Way(const SceneContext& context) : context_(context) {}
  virtual ~Way() = default;

  /// Before, in, and after the runs with one number of samples, the largest number first. end() returns whether the
  /// runs count; then last_row() is theirs.
  virtual void begin(Suite& suite, int spp);
  virtual void render(Suite& suite, int spp, int run) = 0;
  virtual bool end(Suite& suite, int spp) = 0;

  virtual bool may_fail() const { return false; }
  virtual void leave_out() { is_out_ = true; }
  bool is_out() const { return is_out_; }

  const Row& last_row() const { return last_row_; }

  /// Median seconds and mean error of each number of samples, the smallest first.
  std::vector<ErrorAtTime> points() const;

  /// The runs of the number of samples that has the fewest.
  std::size_t rounds() const;

  /// The time to the target of each of so many rounds, in which runs of all numbers of samples are evenly shared out.
  std::vector<double> times_by_round(std::size_t rounds, double target) const;

 protected:
  /// What the runs of one number of samples gave.
  struct Runs {
    std::vector<double> seconds, cpu_seconds;
    std::vector<double> relmse;  ///< by which the time to an error is told
    std::vector<ImageError> errors;
  };

  /// Fields of the row that all ways have.
  void finish_row(Row row, double work);
  void keep() { kept_.push_back(runs_); }

  const SceneContext& context_;
  Runs runs_;

 private:
  bool is_out_ = false;
  Row last_row_;
  std::vector<Runs> kept_;  ///< the largest number of samples first
};

/// A configuration of Raylab.
class OwnWay : public Way {
 public:
  OwnWay(const SceneContext& context, const Configuration& configuration, const Built& built)
      : Way(context), configuration_(configuration), built_(built) {}

  void begin(Suite& suite, int spp) override;
  void render(Suite& suite, int spp, int run) override;
  bool end(Suite& suite, int spp) override;

 private:
  const Configuration& configuration_;
  const Built& built_;
  RayCounts rays_;
  std::vector<RelmseEstimate> estimates_;
};

/// Another renderer, which lives until its runs are too short, or it fails, or the scene is done.
class PeerWay : public Way {
 public:
  /// Starts it; throws as PeerProcess.
  PeerWay(const SceneContext& context, const Peer& peer, Suite& suite);

  void begin(Suite& suite, int spp) override;
  void render(Suite& suite, int spp, int run) override;
  bool end(Suite& suite, int spp) override;
  bool may_fail() const override { return true; }
  void leave_out() override;

 private:
  Peer peer_;
  std::unique_ptr<PeerProcess> process_;
  std::vector<PeerRun> pictures_;
};

}  // namespace raylab::bench
