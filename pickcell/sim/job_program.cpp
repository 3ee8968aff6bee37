#include "pickcell/sim/job_program.hpp"

#include <algorithm>
#include <utility>

#include "pickcell/sim/job_text.hpp"

namespace pickcell::sim {

namespace {

using job_text::words;
using Words = std::vector<std::string_view>;
using Kind = Operand::Kind;

constexpr int kSyntax = 5110, kPositionData = 5120, kNopEndMissing = 5130, kBadJobName = 4190, kBadLabel = 4200,
              kUnknownInstruction = 4230;

class Parser {
 public:
  explicit Parser(std::string_view text) { job_.text = std::string(text); }

  tl::expected<JobProgram, JobError> run() {
    split();
    for (line_ = 0; line_ < static_cast<int>(text_lines_.size()) && !error_; ++line_)
      take(text_lines_[static_cast<std::size_t>(line_)]);
    if (!error_ && !in_instructions_) refuse(kNopEndMissing, "no //INST section");
    if (!error_) check_frame();
    if (!error_) resolve();
    if (error_) return tl::unexpected(*error_);
    return std::move(job_);
  }

 private:
  void refuse(int number, std::string why) {
    if (!error_) error_ = JobError{number, line_ + 1, std::move(why)};
  }

  void split() {
    std::string_view rest = job_.text;
    while (!rest.empty()) {
      const std::size_t end = rest.find("\r\n");
      text_lines_.push_back(rest.substr(0, end));
      if (end == std::string_view::npos) break;
      rest.remove_prefix(end + 2);
    }
  }

  void take(std::string_view line) {
    if (line.find('\n') != std::string_view::npos || line.find('\r') != std::string_view::npos)
      return refuse(kNopEndMissing, "lines must end with CR LF: NOP and END are not found");
    if (line_ == 0) {
      if (line != "/JOB") refuse(kSyntax, "a job begins with /JOB");
      return;
    }
    if (in_instructions_ && !line.starts_with("//")) return instruction(line);
    if (line.empty()) return;
    if (line.starts_with("//")) return header(line);
    if (line.front() == 'P' || line.front() == 'C' || line.starts_with("BC") || line.starts_with("EX"))
      return position(line);
    refuse(kSyntax, "unexpected text outside of the instructions");
  }

  void header(std::string_view line) {
    const Words w = words(line);
    const auto argument = [&] { return w.size() > 1 ? w[1] : std::string_view{}; };
    if (w[0] == "//NAME") {
      if (!job_text::job_name(argument())) return refuse(kBadJobName, "job name: at most 32 characters, upper case");
      job_.name = std::string(argument());
    } else if (w[0] == "//INST") {
      in_instructions_ = true;
    } else if (w[0] == "///TOOL" || w[0] == "///USER") {
      const auto n = job_text::whole(argument());
      if (!n || *n < 0 || *n > 63) return refuse(kPositionData, std::string(w[0]) + " needs a number 0-63");
      (w[0] == "///TOOL" ? pos_.tool : user_) = *n;
    } else if (w[0] == "///POSTYPE") {
      postype_ = std::string(argument());
    } else if (w[0] == "///RECTAN") {
      pos_.pulse = false;
    } else if (w[0] == "///PULSE") {
      pos_.pulse = true;
    } else if (w[0] == "///RCONF") {
      configuration(argument());
    }
    // Everything else (///NPOS, ///DATE, ///ATTR, ///GROUP1, ...) says nothing that this controller uses.
  }

  /// The first six flags are the form in the order of TCP port 80.
  void configuration(std::string_view flags) {
    pos_.form = 0;
    for (int bit = 0; bit < 6 && !flags.empty(); ++bit) {
      if (flags.front() == '1') pos_.form |= 1 << bit;
      const std::size_t comma = flags.find(',');
      flags.remove_prefix(comma == std::string_view::npos ? flags.size() : comma + 1);
    }
  }

  void position(std::string_view line) {
    const std::size_t equals = line.find('=');
    const auto variable = job_text::operand(line.substr(0, equals));
    if (equals == std::string_view::npos || !variable || (variable->kind != Kind::P && variable->kind != Kind::C))
      return refuse(kPositionData, "not a position of the robot");
    const auto axis = job_text::six(line.substr(equals + 1), pos_.pulse ? 0 : 3, pos_.pulse ? 0 : 4);
    if (!axis) return refuse(kPositionData, "a position has six numbers");
    Position p = pos_;
    p.axis = *axis;
    if (!p.pulse) {
      if (postype_ == "BASE")
        p.frame = 0;
      else if (postype_ == "ROBOT")
        p.frame = 1;
      else if (postype_ == "USER" && user_ >= 1)
        p.frame = 1 + user_;
      else
        return refuse(kPositionData, "///POSTYPE must be BASE, ROBOT or USER (with ///USER)");
    }
    if (variable->kind == Kind::P && variable->index > 127) return refuse(kPositionData, "P variables are 0-127");
    (variable->kind == Kind::P ? job_.p_variables : job_.taught)[variable->index] = p;
  }

  void instruction(std::string_view line) {
    current_ = {};
    const Words w = words(line);
    if (w.empty() || w[0].front() == '\'')
      current_.op = Op::comment;
    else if (w[0].front() == '*')
      label(w);
    else
      statement(line, w);
    text_line_of_.push_back(line_);
    job_.lines.push_back(std::move(current_));
  }

  void label(const Words& w) {
    current_.op = Op::label;
    if (w.size() != 1 || w[0].size() < 2 || w[0].size() > 9)
      return refuse(kBadLabel, "a label has one to eight characters after the star");
    if (!labels_.emplace(std::string(w[0]), job_.lines.size()).second) refuse(kBadLabel, "label given twice");
  }

  void statement(std::string_view line, const Words& w) {
    struct Form {
      std::string_view word;
      Op op;
      void (Parser::*read)(std::string_view, const Words&);
    };
    static const Form forms[] = {{"NOP", Op::nop, &Parser::bare},
                                 {"END", Op::end, &Parser::bare},
                                 {"RET", Op::ret, &Parser::bare},
                                 {"PAUSE", Op::pause, &Parser::bare},
                                 {"ELSE", Op::otherwise, &Parser::bare},
                                 {"ENDIF", Op::end_if, &Parser::bare},
                                 {"ENDWHILE", Op::end_while, &Parser::bare},
                                 {"JUMP", Op::jump, &Parser::jump},
                                 {"CALL", Op::call, &Parser::call},
                                 {"SET", Op::set, &Parser::arithmetic},
                                 {"ADD", Op::add, &Parser::arithmetic},
                                 {"SUB", Op::sub, &Parser::arithmetic},
                                 {"MUL", Op::mul, &Parser::arithmetic},
                                 {"DIV", Op::div, &Parser::arithmetic},
                                 {"INC", Op::inc, &Parser::count},
                                 {"DEC", Op::dec, &Parser::count},
                                 {"GETE", Op::get_element, &Parser::element},
                                 {"SETE", Op::set_element, &Parser::element},
                                 {"MOVJ", Op::move_joint, &Parser::move},
                                 {"MOVL", Op::move_line, &Parser::move},
                                 {"TIMER", Op::timer, &Parser::timer},
                                 {"DOUT", Op::output, &Parser::output},
                                 {"WAIT", Op::wait, &Parser::wait},
                                 {"IFTHENEXP", Op::if_then, &Parser::block},
                                 {"ELSEIFEXP", Op::else_if, &Parser::block},
                                 {"WHILEEXP", Op::while_do, &Parser::block}};
    for (const Form& form : forms)
      if (form.word == w[0]) {
        current_.op = form.op;
        return (this->*form.read)(line, w);
      }
    refuse(kUnknownInstruction, "unknown instruction " + std::string(w[0]));
  }

  void bare(std::string_view, const Words& w) {
    if (w.size() != 1) syntax(w[0]);
  }

  void syntax(std::string_view word) { refuse(kSyntax, "syntax of " + std::string(word)); }

  /// The text after the word IF (or after the first word).
  std::optional<Condition> condition_after(std::string_view line, std::string_view word) {
    const std::size_t from = static_cast<std::size_t>(word.data() + word.size() - line.data());
    return job_text::condition(line.substr(from));
  }

  void optional_if(std::string_view line, const Words& w) {
    if (w.size() == 2) return;
    if (w.size() < 4 || w[2] != "IF") return syntax(w[0]);
    current_.condition = condition_after(line, w[2]);
    if (!current_.condition) syntax(w[0]);
  }

  void jump(std::string_view line, const Words& w) {
    if (w.size() < 2 || w[1].front() != '*') return syntax(w[0]);
    current_.text = std::string(w[1]);
    optional_if(line, w);
  }

  void call(std::string_view line, const Words& w) {
    if (w.size() < 2 || !w[1].starts_with("JOB:") || !job_text::job_name(w[1].substr(4))) return syntax(w[0]);
    current_.text = std::string(w[1].substr(4));
    optional_if(line, w);
  }

  static bool numeric(const Operand& o) {
    return o.kind == Kind::B || o.kind == Kind::I || o.kind == Kind::D || o.kind == Kind::R;
  }

  void arithmetic(std::string_view, const Words& w) {
    const auto a = w.size() == 3 ? job_text::operand(w[1]) : std::nullopt;
    const auto b = a ? job_text::operand(w[2]) : std::nullopt;
    if (!b) return syntax(w[0]);
    const bool numbers = numeric(*a) && (numeric(*b) || b->kind == Kind::number);
    const bool positions = a->kind == Kind::P && b->kind == Kind::P && current_.op == Op::set;
    const bool texts = a->kind == Kind::S && (b->kind == Kind::S || b->kind == Kind::text) && current_.op == Op::set;
    if (!numbers && !positions && !texts) return syntax(w[0]);
    current_.a = *a;
    current_.b = *b;
  }

  void count(std::string_view, const Words& w) {
    const auto a = w.size() == 2 ? job_text::operand(w[1]) : std::nullopt;
    if (!a || !numeric(*a)) return syntax(w[0]);
    current_.a = *a;
  }

  /// GETE D020 P020 (3), SETE P020 (3) D020.
  void element(std::string_view, const Words& w) {
    const bool get = current_.op == Op::get_element;
    if (w.size() != 4) return syntax(w[0]);
    const auto value = job_text::operand(w[get ? 1 : 3]);
    const auto p = job_text::operand(w[get ? 2 : 1]);
    const auto n = job_text::bracketed(w[get ? 3 : 2]);
    if (!value || !p || !n || p->kind != Kind::P || *n < 1 || *n > 6) return syntax(w[0]);
    if (value->kind != Kind::D && (get || value->kind != Kind::number)) return syntax(w[0]);
    current_.a = *p;
    current_.b = *value;
    current_.element = *n;
  }

  void move(std::string_view, const Words& w) {
    const auto p = w.size() >= 3 ? job_text::operand(w[1]) : std::nullopt;
    if (!p || (p->kind != Kind::P && p->kind != Kind::C)) return syntax(w[0]);
    current_.a = *p;
    bool speed = false;
    for (std::size_t i = 2; i < w.size(); ++i) {
      const auto in = [&](std::string_view key, double low, double high) {
        const auto v = job_text::setting(w[i], key);
        if (!v || *v < low || *v > high) return false;
        current_.value = *v;
        return speed = true;
      };
      const auto corner = job_text::setting(w[i], "PL");
      if (current_.op == Op::move_joint && in("VJ", 0.01, 100)) continue;
      if (current_.op == Op::move_line && in("V", 0.1, 1500)) continue;
      if (current_.op == Op::move_line && in("VR", 0.1, 180)) {
        current_.turning = true;
        continue;
      }
      if (corner && *corner >= 0 && *corner <= 8) continue;  // corners are not rounded here: every point is reached
      return syntax(w[0]);
    }
    if (!speed) syntax(w[0]);
  }

  void timer(std::string_view, const Words& w) {
    const auto t = w.size() == 2 ? job_text::setting(w[1], "T") : std::nullopt;
    if (!t || *t < 0.01 || *t > 655.35) return syntax(w[0]);
    current_.value = *t;
  }

  void output(std::string_view, const Words& w) {
    const auto contact = w.size() == 3 ? job_text::operand(w[1]) : std::nullopt;
    if (!contact || contact->kind != Kind::OT || (w[2] != "ON" && w[2] != "OFF")) return syntax(w[0]);
    current_.a = *contact;
    current_.value = w[2] == "ON" ? 1 : 0;
  }

  void wait(std::string_view line, const Words& w) {
    current_.value = -1;  // for ever
    std::string_view text = line;
    if (const auto t = job_text::setting(w.back(), "T"); t && *t >= 0 && *t <= 655.35) {
      current_.value = *t;
      text = line.substr(0, static_cast<std::size_t>(w.back().data() - line.data()));
    }
    current_.condition = condition_after(text, w[0]);
    if (!current_.condition) syntax(w[0]);
  }

  void block(std::string_view line, const Words& w) {
    current_.condition = condition_after(line, w[0]);
    if (!current_.condition) syntax(w[0]);
  }

  void check_frame() {
    if (job_.name.empty()) return refuse(kBadJobName, "no //NAME");
    while (job_.lines.size() > 1 && job_.lines.back().op == Op::comment) job_.lines.pop_back();  // empty text after END
    if (job_.lines.size() < 2 || job_.lines.front().op != Op::nop || job_.lines.back().op != Op::end)
      refuse(kNopEndMissing, "the first instruction must be NOP, the last one END");
  }

  void resolve() {
    for (std::size_t i = 0; i < job_.lines.size() && !error_; ++i) {
      line_ = text_line_of_[i];
      Instruction& at = job_.lines[i];
      switch (at.op) {
        case Op::jump:
          resolve_jump(at);
          break;
        case Op::if_then:
        case Op::while_do:
          blocks_.push_back({i});
          break;
        case Op::else_if:
        case Op::otherwise:
          branch(i);
          break;
        case Op::end_if:
          end_if(i);
          break;
        case Op::end_while:
          end_while(i);
          break;
        default:
          break;
      }
    }
    if (!blocks_.empty()) refuse(kSyntax, "IFTHENEXP or WHILEEXP without its end");
  }

  void resolve_jump(Instruction& jump) {
    const auto found = labels_.find(jump.text);
    if (found == labels_.end()) return refuse(kBadLabel, "no such label: " + jump.text);
    jump.target = found->second;
  }

  [[nodiscard]] bool inside(Op first) const {
    return !blocks_.empty() && job_.lines[blocks_.back().front()].op == first;
  }

  void branch(std::size_t i) {
    if (!inside(Op::if_then) || job_.lines[blocks_.back().back()].op == Op::otherwise)
      return refuse(kSyntax, "ELSE without IFTHENEXP");
    blocks_.back().push_back(i);
  }

  void end_if(std::size_t i) {
    if (!inside(Op::if_then)) return refuse(kSyntax, "ENDIF without IFTHENEXP");
    const std::vector<std::size_t>& heads = blocks_.back();
    for (std::size_t k = 0; k < heads.size(); ++k) {
      job_.lines[heads[k]].target = k + 1 < heads.size() ? heads[k + 1] : i;
      job_.lines[heads[k]].exit = i;
    }
    blocks_.pop_back();
  }

  void end_while(std::size_t i) {
    if (!inside(Op::while_do)) return refuse(kSyntax, "ENDWHILE without WHILEEXP");
    job_.lines[i].target = blocks_.back().front();
    job_.lines[blocks_.back().front()].target = i + 1;
    blocks_.pop_back();
  }

  JobProgram job_;
  std::vector<std::string_view> text_lines_;
  std::optional<JobError> error_;
  int line_ = 0;
  bool in_instructions_ = false;
  Position pos_;
  int user_ = 0;
  std::string postype_ = "BASE";
  Instruction current_;
  std::vector<int> text_line_of_;
  std::map<std::string, std::size_t, std::less<>> labels_;
  std::vector<std::vector<std::size_t>> blocks_;  ///< open ones: lines of IFTHENEXP, ELSEIFEXP, ELSE or of WHILEEXP
};

}  // namespace

int JobProgram::step_at(std::size_t line) const {
  const auto end = lines.begin() + static_cast<std::ptrdiff_t>(std::min(line + 1, lines.size()));
  return static_cast<int>(std::count_if(
      lines.begin(), end, [](const Instruction& i) { return i.op == Op::move_joint || i.op == Op::move_line; }));
}

tl::expected<JobProgram, JobError> parse_job(std::string_view text) { return Parser(text).run(); }

}  // namespace pickcell::sim
